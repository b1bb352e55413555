// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "pointsweep/error.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

TEST(NpyReader, ReadsWhatTheWriterWrites) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "a.npy", 3);
  plan.schema.append("neighbors", Type::u32, 2);
  const std::uint32_t rows[] = {1, 2, 0, 2, 1, 0xffffffff};
  const auto writer = create_npy_writer(plan);
  writer->write(std::as_bytes(std::span(rows)));
  writer->finish();
  const auto reader = open_npy(folder / "a.npy");
  EXPECT_EQ(reader->info().count, 3u);
  EXPECT_EQ(field_names(reader->info().schema), (std::vector<std::string>{"neighbor_0", "neighbor_1"}));
  EXPECT_EQ(values_of(*reader, "neighbor_1"), (std::vector<double>{2, 2, 0xffffffff}));
}

std::string array_of(std::string dictionary, std::size_t bytes) {
  std::string file = "\x93NUMPY\x01";
  file += '\0';
  file += static_cast<char>(dictionary.size());
  file += '\0';
  return file + dictionary + std::string(bytes, '\0');
}

TEST(NpyReader, RefusesInASentence) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::string& content, const std::string& words) {
    const auto path = folder.write("a.npy", content);
    const std::string sentence = sentence_of<Error>([&] { open_npy(path); });
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
    EXPECT_EQ(sentence.back(), '.');
  };
  const std::string good = "{'descr': '<u4', 'fortran_order': False, 'shape': (2, 3), }";
  folder.write("good.npy", array_of(good, 24));
  EXPECT_EQ(open_npy(folder / "good.npy")->info().count, 2u);
  refuses(array_of(good, 23), "but 23 bytes follow");
  refuses(array_of("{'descr': '<u4', 'fortran_order': False, 'shape': (99999999999, 3), }", 24), "(99999999999, 3)");
  refuses(array_of("{'descr': '<f2', 'fortran_order': False, 'shape': (2, 3), }", 12), "<f2");
  refuses(array_of("{'descr': '<u4', 'fortran_order': True, 'shape': (2, 3), }", 24), "Fortran");
  refuses(array_of("{'descr': '<u4', 'fortran_order': False, 'shape': (2, 3, 4), }", 96), "shape");
  refuses(array_of("{'descr': '<u4', 'fortran_order': False, 'shape': (2, 99999999999999999999), }", 24), "shape");
  refuses(array_of("{'descr': '<u4', 'fortran_order': False, 'shape': (2, 0), }", 0), "shape");
  refuses(array_of("{'descr': '<u4', 'fortran_order': False}", 24), "has no 'shape'");
  refuses(std::string("\x93NUMPY\x01\x00\xff\xff{'descr'", 18), "cut off");
  refuses("ply\nformat ascii 1.0\n", "is no NumPy array");
}

}  // namespace
}  // namespace pointsweep
