// SPDX-License-Identifier: MIT
/// URLs: names that are URLs, the parts that are shown, and the parts that are kept for requests.
#include "pointsweep/storage/remote/url.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "pointsweep/formats/files/file_pattern.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/storage/local/place.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

TEST(Url, BeginsWithASchemeAndTwoSlashes) {
  for (const char* url : {"https://host/a.laz", "s3://bucket", "gs://b/c", "az://c/d", "abfs://c@account/d", "ftp://x"})
    EXPECT_TRUE(is_url(std::string(url))) << url;
  for (const char* path :
       {"", "a.laz", "/a//b", "://a", "c://a", "s3:/bucket/a", "a b://c", "./https://host/a", "1a://b"})
    EXPECT_FALSE(is_url(std::string(path))) << path;
}

TEST(Url, OfABucketCanBeListed) {
  EXPECT_TRUE(is_bucket("s3://bucket/a"));
  EXPECT_TRUE(is_bucket("az://container/a"));
  EXPECT_FALSE(is_bucket("https://host/a"));
  EXPECT_FALSE(is_bucket("a/b"));
}

TEST(KnownPlace, OfAFileUrlIsItsPath) {
  EXPECT_EQ(known_place("file:///tmp/a%20b.laz"), fs::path("/tmp/a b.laz"));
  EXPECT_EQ(known_place("file://localhost/a.laz"), fs::path("/a.laz"));
  EXPECT_EQ(known_place("file:///tmp/100%.laz"), fs::path("/tmp/100%.laz"));
}

TEST(KnownPlace, HasNoSecretsAndKeepsThemForRequests) {
  const struct {
    const char *named, *shown;
  } cases[] = {
      {"https://me:hunter2@host:8080/a.laz", "https://host:8080/a.laz"},
      {"https://token@host/a.laz", "https://host/a.laz"},
      {"https://b.s3.amazonaws.com/a.laz?X-Amz-Date=1&X-Amz-Signature=abc", "https://b.s3.amazonaws.com/a.laz"},
      {"https://a.blob.core.windows.net/c/a.laz?sv=2020&SIG=abc%3D", "https://a.blob.core.windows.net/c/a.laz"},
      {"https://storage.googleapis.com/b/a.laz?X-Goog-Signature=1", "https://storage.googleapis.com/b/a.laz"},
      {"s3://key:secret@bucket/a.laz", "s3://bucket/a.laz"},
  };
  for (const auto& [named, shown] : cases) {
    EXPECT_EQ(known_place(named), fs::path(shown));
    EXPECT_EQ(address_of(shown), named);
  }
}

TEST(KnownPlace, IsAnyOtherNameItself) {
  for (const char* name :
       {"a.laz", "https://without-secrets/a.laz", "https://host/download?id=7&name=a.laz", "s3://bucket/a?b.laz",
        "abfs://container@account.dfs.core.windows.net/a.laz", "s3://bucket/a@b.laz"}) {
    EXPECT_EQ(known_place(name), fs::path(name));
    EXPECT_EQ(address_of(name), name);
  }
}

TEST(KnownPlace, ReplacesTheUrlsOfAText) {
  EXPECT_EQ(with_known_places("distance_to(cloud=https://h/a.laz?sig=1, most=2) | normals"),
            "distance_to(cloud=https://h/a.laz, most=2) | normals");
  EXPECT_EQ(with_known_places("take(cloud='https://u:p@h/a.laz') | take(cloud=s3://b/c)"),
            "take(cloud='https://h/a.laz') | take(cloud=s3://b/c)");
  EXPECT_EQ(with_known_places("https://h/a,b (1).laz?token=x"), "https://h/a,b (1).laz");
  EXPECT_EQ(with_known_places("--crs=://"), "--crs=://");
  EXPECT_EQ(with_known_places(""), "");
}

TEST(Url, GoesThroughPathsWithBothSlashes) {
  const fs::path folder = "s3://bucket/tiles/";
  EXPECT_EQ((folder / "a.laz").string(), "s3://bucket/tiles/a.laz");
  EXPECT_EQ((fs::path("s3://bucket/tiles") / "").string(), "s3://bucket/tiles/");
  EXPECT_EQ((folder / "a.laz").parent_path().string(), "s3://bucket/tiles");
  EXPECT_EQ(whole_name(folder / "a.laz"), "s3://bucket/tiles/a.laz");
  EXPECT_TRUE(is_folder(folder));
  EXPECT_FALSE(is_folder("s3://bucket/tiles"));
  EXPECT_TRUE(share_folder("s3://b/x/a.laz", "s3://b/x/*.laz"));
  EXPECT_FALSE(share_folder("s3://b/x/a.laz", "s3://b/y/*.laz"));
  EXPECT_FALSE(share_folder("s3://b/x/a.laz", "a.laz"));
}

TEST(Url, HasTheExtensionBeforeItsQuery) {
  EXPECT_EQ(extension_of("https://host/a.copc.laz?id=b/c.ply"), ".copc.laz");
  EXPECT_EQ(file_name("https://host/a.PLY?x=1"), fs::path("a.PLY"));
  EXPECT_EQ(extension_of("s3://bucket/a?b.laz"), ".laz");
  EXPECT_EQ(extension_of("https://host/"), "");
}

TEST(Url, ResolvesReferencesOfADocument) {
  const std::string base = "https://host/data/set.vpc?v=1";
  EXPECT_EQ(resolved(base, "a.laz"), "https://host/data/a.laz");
  EXPECT_EQ(resolved(base, "./x/../a.laz"), "https://host/data/a.laz");
  EXPECT_EQ(resolved(base, "../a.laz"), "https://host/a.laz");
  EXPECT_EQ(resolved(base, "../../../a.laz"), "https://host/a.laz");
  EXPECT_EQ(resolved(base, "/a.laz"), "https://host/a.laz");
  EXPECT_EQ(resolved(base, "s3://bucket/a.laz"), "s3://bucket/a.laz");
  EXPECT_EQ(resolved("s3://bucket/set.vpc", "tiles/a.laz"), "s3://bucket/tiles/a.laz");
}

TEST(RemotePattern, BeginsInAFolderThatIsFixed) {
  EXPECT_TRUE(is_remote_pattern("s3://bucket/tiles/*.laz"));
  EXPECT_TRUE(is_remote_pattern("s3://bucket/tile_?.laz"));
  EXPECT_FALSE(is_remote_pattern("s3://bucket/tiles/a.laz"));
  EXPECT_FALSE(is_remote_pattern("https://host/a.laz?id=1"));
  EXPECT_EQ(fixed_remote_part("s3://bucket/tiles/*/a.laz"), fs::path("s3://bucket/tiles/"));
  EXPECT_EQ(fixed_remote_part("s3://bucket/t*"), fs::path("s3://bucket/"));
}

}  // namespace
}  // namespace pointsweep
