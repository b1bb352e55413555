/* SPDX-License-Identifier: MIT */
/* LASzip compression of LAS point records, chunk by chunk, with the crate `laz`, and the scans of E57 files, with the crate
 * `e57`. Implemented in Rust (codecs/src).
 *
 * Functions that can fail return 0, or -1 with a sentence in `error`. No panic crosses this interface. Different
 * decoders, and encoders on the same layout, may run on different threads at the same time. Nothing is allocated in
 * proportion to a number that a file claims before as many bytes of the file were seen. */
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

/* What the LASzip VLR says: the parts of a record, how each is compressed, and the size of chunks. */
typedef struct psc_laz psc_laz;

/* Reads the content of the VLR of user "laszip encoded", record 22204. */
int psc_laz_parse(const uint8_t* vlr, size_t bytes, psc_laz** out, psc_error* error);
/* For writing: records of a point format (0 to 10) with extra bytes, in chunks of `chunk_points`. */
int psc_laz_for_format(uint8_t point_format, uint16_t extra_bytes, uint32_t chunk_points, psc_laz** out, psc_error* error);
void psc_laz_free(psc_laz* laz);

uint32_t psc_laz_record_bytes(const psc_laz* laz);
/* Points in each chunk but the last; 0 if the chunk table says how many; UINT32_MAX if there are no chunks: all points
 * in one run, and neither a chunk table nor an offset to it. */
uint32_t psc_laz_chunk_points(const psc_laz* laz);
/* The content of the VLR. Returns its size; nothing is written if `room` is less. */
size_t psc_laz_vlr(const psc_laz* laz, uint8_t* into, size_t room);

/* A chunk table of `count` chunks, which must be what its own header says: points (of each chunk, if they vary, else 0)
 * and compressed bytes. */
int psc_laz_read_chunk_table(const psc_laz* laz, const uint8_t* table, size_t bytes, size_t count, uint64_t* points,
                             uint64_t* sizes, psc_error* error);
/* Bytes that psc_free_bytes() frees. */
int psc_laz_write_chunk_table(const psc_laz* laz, const uint64_t* points, const uint64_t* sizes, size_t count, uint8_t** out,
                              size_t* bytes, psc_error* error);

/* Reads `bytes` at `offset` of the compressed file, returns how many it read, 0 at the end, or less than 0 on failure. */
typedef ptrdiff_t (*psc_read)(void* context, uint64_t offset, uint8_t* into, size_t bytes);

/* Of one chunk, from its first record to its last. */
typedef struct psc_laz_decoder psc_laz_decoder;

/* A chunk at bytes [begin, end) of the file. */
int psc_laz_decoder_open(const psc_laz* laz, psc_read read, void* context, uint64_t begin, uint64_t end,
                         psc_laz_decoder** out, psc_error* error);
/* Fills `records` with the next ones, as many whole ones as fit into `bytes`; those beyond the end of the chunk have no
 * meaning, or are an error. */
int psc_laz_decode(psc_laz_decoder* decoder, uint8_t* records, size_t bytes, psc_error* error);
void psc_laz_decoder_free(psc_laz_decoder* decoder);

/* Compresses whole records, at least one, to a chunk. Bytes that psc_free_bytes() frees. */
int psc_laz_encode(const psc_laz* laz, const uint8_t* records, size_t bytes, uint8_t** out, size_t* out_bytes, psc_error* error);

/* What an E57 file says of its scans. */
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
  char name[256];      /* as in the file, e.g. cartesianX; with a final 0 */
  int32_t kind;        /* PSC_E57_SINGLE, ... */
  int64_t least, most; /* of stored integers, before scale and offset */
  double scale, offset;
} psc_e57_attribute;

/* A file of `size` bytes. */
int psc_e57_open(psc_read read, void* context, uint64_t size, psc_e57** out, psc_error* error);
void psc_e57_free(psc_e57* file);
size_t psc_e57_scans(const psc_e57* file);
size_t psc_e57_images(const psc_e57* file);
/* What the file says of its coordinate system, without a final 0. Returns its size; nothing is written if `room` is less. */
size_t psc_e57_coordinate_system(const psc_e57* file, uint8_t* into, size_t room);
/* The same for the description of a scan. */
size_t psc_e57_description(const psc_e57* file, size_t scan, uint8_t* into, size_t room);
void psc_e57_scan_info(const psc_e57* file, size_t scan, psc_e57_scan* out);
void psc_e57_attribute_info(const psc_e57* file, size_t scan, size_t attribute, psc_e57_attribute* out);

/* Points of one scan, from the first to the last. Does not need the psc_e57 any more. */
typedef struct psc_e57_reader psc_e57_reader;
int psc_e57_reader_open(const psc_e57* file, size_t scan, psc_read read, void* context, uint64_t size, psc_e57_reader** out,
                        psc_error* error);
/* The next points: `count` values, one for each attribute of each point, as the bits of a double (PSC_E57_SINGLE and
 * PSC_E57_DOUBLE) or as an integer, without its scale. It is an error to ask for more points than there are. */
int psc_e57_read(psc_e57_reader* reader, uint64_t* values, size_t count, psc_error* error);
void psc_e57_reader_free(psc_e57_reader* reader);

/* Writes `bytes` at `offset` of the new file. Returns 0, or less than 0 on failure. */
typedef int (*psc_write)(void* context, uint64_t offset, const uint8_t* bytes, size_t size);

/* What a new file says in addition to its points; texts in UTF-8 with a final 0. */
typedef struct psc_e57_about {
  const char* guid;              /* of the file and of its scan */
  const char* description;       /* of its scan; may be empty */
  const char* coordinate_system; /* WKT; may be empty */
} psc_e57_about;

/* A new file of one scan. Names of attributes are those of the standard, "nor:normalX" and its like, or "ps:NAME" for all
 * others. The functions are called until psc_e57_writer_free(). */
typedef struct psc_e57_writer psc_e57_writer;
int psc_e57_writer_create(psc_read read, psc_write write, void* context, const psc_e57_attribute* attributes, size_t count,
                          const psc_e57_about* about, psc_e57_writer** out, psc_error* error);
/* The next points, in the form in which psc_e57_read() gives them. */
int psc_e57_write(psc_e57_writer* writer, const uint64_t* values, size_t count, psc_error* error);
/* Completes the file. Nothing may follow. */
int psc_e57_writer_finish(psc_e57_writer* writer, psc_error* error);
void psc_e57_writer_free(psc_e57_writer* writer);

void psc_free_bytes(uint8_t* bytes, size_t size);

#ifdef __cplusplus
}
#endif
#endif
