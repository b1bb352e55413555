/* SPDX-License-Identifier: MIT */
/* LASzip compression of LAS point records, chunk by chunk, with the crate `laz`, and the scans of E57 files, with the
 * crate `e57`. Implemented in Rust (codecs/src).
 *
 * Functions that can fail return 0, or -1 with a sentence in `error`. No panic crosses this interface. Different
 * decoders, and encoders on the same layout, may run on different threads at the same time. Memory in proportion to a
 * number that a file claims is allocated only after the file is known to have as many bytes. The caller frees each
 * object that a function stores in `out` by the function psc_..._free() of its type. */
#ifndef POINTSWEEP_CODECS_H
#define POINTSWEEP_CODECS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct psc_error {
  char text[256]; /* with a final 0 */
} psc_error;

/* The content of the LASzip VLR: the parts of a record, the compression of each part, and the size of chunks. */
typedef struct psc_laz psc_laz;

/* Decodes the content of the VLR of user "laszip encoded", record 22204. */
int psc_laz_parse(const uint8_t* vlr, size_t bytes, psc_laz** out, psc_error* error);
/* Makes a layout for writing records of a point format (0 to 10) with extra bytes, in chunks of `chunk_points` points;
 * 0 for chunks with varying numbers of points. */
int psc_laz_for_format(uint8_t point_format, uint16_t extra_bytes, uint32_t chunk_points, psc_laz** out, psc_error* error);
void psc_laz_free(psc_laz* laz);

uint32_t psc_laz_record_bytes(const psc_laz* laz);
/* Returns the points in each chunk but the last; 0 if the chunk table states the points of each chunk; UINT32_MAX if
 * all points are in one run, with neither a chunk table nor an offset to a table. */
uint32_t psc_laz_chunk_points(const psc_laz* laz);
/* Copies the content of the VLR to `into` if `room` bytes are enough. Returns the size of the content. */
size_t psc_laz_vlr(const psc_laz* laz, uint8_t* into, size_t room);

/* Decodes a chunk table: for each of `count` chunks the number of points (0 unless psc_laz_chunk_points() is 0) and of
 * compressed bytes. Fails unless the header of the table states `count` chunks. */
int psc_laz_read_chunk_table(const psc_laz* laz, const uint8_t* table, size_t bytes, size_t count, uint64_t* points,
                             uint64_t* sizes, psc_error* error);
/* Encodes a chunk table. The caller frees the bytes by psc_free_bytes(). */
int psc_laz_write_chunk_table(const psc_laz* laz, const uint64_t* points, const uint64_t* sizes, size_t count, uint8_t** out,
                              size_t* bytes, psc_error* error);

/* Reads up to `bytes` bytes at `offset` of the file. Returns the number of bytes read, 0 at the end of the file, or
 * less than 0 on failure. */
typedef ptrdiff_t (*psc_read)(void* context, uint64_t offset, uint8_t* into, size_t bytes);

/* A decoder of one chunk, from its first record to its last. */
typedef struct psc_laz_decoder psc_laz_decoder;

/* Opens a decoder of the chunk at bytes [begin, end) of the file. `read` is called until psc_laz_decoder_free(). */
int psc_laz_decoder_open(const psc_laz* laz, psc_read read, void* context, uint64_t begin, uint64_t end,
                         psc_laz_decoder** out, psc_error* error);
/* Decodes the next records, as many whole records as fit in `bytes` bytes. Records beyond the end of the chunk are
 * meaningless, or an error. */
int psc_laz_decode(psc_laz_decoder* decoder, uint8_t* records, size_t bytes, psc_error* error);
void psc_laz_decoder_free(psc_laz_decoder* decoder);

/* Compresses whole records, at least one, to a chunk. The caller frees the bytes by psc_free_bytes(). */
int psc_laz_encode(const psc_laz* laz, const uint8_t* records, size_t bytes, uint8_t** out, size_t* out_bytes, psc_error* error);

/* The descriptions of the scans of an E57 file, which do not refer to the open file. */
typedef struct psc_e57 psc_e57;

typedef struct psc_e57_scan {
  uint64_t points;
  size_t attributes;
  int32_t has_pose;
  double rotation[4]; /* unit quaternion w, x, y, z */
  double translation[3];
} psc_e57_scan;

enum { PSC_E57_SINGLE = 0, PSC_E57_DOUBLE = 1, PSC_E57_SCALED_INTEGER = 2, PSC_E57_INTEGER = 3 };

typedef struct psc_e57_attribute {
  char name[256];      /* name in the file, e.g. cartesianX; with a final 0 */
  int32_t kind;        /* PSC_E57_SINGLE, ... */
  int64_t least, most; /* range of stored integers, before scale and offset */
  double scale, offset;
} psc_e57_attribute;

/* Reads the descriptions from a file of `size` bytes. `read` is called only before the function returns. */
int psc_e57_open(psc_read read, void* context, uint64_t size, psc_e57** out, psc_error* error);
void psc_e57_free(psc_e57* file);
size_t psc_e57_scans(const psc_e57* file);
size_t psc_e57_images(const psc_e57* file);
/* Copies the text about the coordinate system, without a final 0, if `room` bytes are enough. Returns the size of the
 * text; 0 if the file has no such text. */
size_t psc_e57_coordinate_system(const psc_e57* file, uint8_t* into, size_t room);
/* Copies the description of a scan like psc_e57_coordinate_system(). */
size_t psc_e57_description(const psc_e57* file, size_t scan, uint8_t* into, size_t room);
void psc_e57_scan_info(const psc_e57* file, size_t scan, psc_e57_scan* out);
void psc_e57_attribute_info(const psc_e57* file, size_t scan, size_t attribute, psc_e57_attribute* out);

/* A reader of the points of one scan, from the first to the last. The reader may outlive the psc_e57. `read` is called
 * until psc_e57_reader_free(). */
typedef struct psc_e57_reader psc_e57_reader;
int psc_e57_reader_open(const psc_e57* file, size_t scan, psc_read read, void* context, uint64_t size, psc_e57_reader** out,
                        psc_error* error);
/* Reads the next points: `count` values, one for each attribute of each point, as the bits of a double (PSC_E57_SINGLE
 * and PSC_E57_DOUBLE) or as an integer, without its scale. More points than the scan has are an error. */
int psc_e57_read(psc_e57_reader* reader, uint64_t* values, size_t count, psc_error* error);
void psc_e57_reader_free(psc_e57_reader* reader);

/* Writes `size` bytes at `offset` of the new file. Returns 0; any other value means failure. */
typedef int (*psc_write)(void* context, uint64_t offset, const uint8_t* bytes, size_t size);

/* The statements of a new file in addition to its points; texts in UTF-8 with a final 0. */
typedef struct psc_e57_about {
  const char* guid;              /* identifier of the file and of its scan */
  const char* description;       /* description of the scan; may be empty */
  const char* coordinate_system; /* WKT; may be empty */
} psc_e57_about;

/* A writer of a new file with one scan. Attributes have a name of the standard, a name like "nor:normalX" of the
 * extension for normals, or any other name as "ps:NAME". `read` and `write` are called until psc_e57_writer_free(). */
typedef struct psc_e57_writer psc_e57_writer;
int psc_e57_writer_create(psc_read read, psc_write write, void* context, const psc_e57_attribute* attributes, size_t count,
                          const psc_e57_about* about, psc_e57_writer** out, psc_error* error);
/* Appends points, in the form in which psc_e57_read() returns points. */
int psc_e57_write(psc_e57_writer* writer, const uint64_t* values, size_t count, psc_error* error);
/* Completes the file. Only psc_e57_writer_free() may follow. */
int psc_e57_writer_finish(psc_e57_writer* writer, psc_error* error);
void psc_e57_writer_free(psc_e57_writer* writer);

void psc_free_bytes(uint8_t* bytes, size_t size);

#ifdef __cplusplus
}
#endif
#endif
