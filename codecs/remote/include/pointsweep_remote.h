/* SPDX-License-Identifier: MIT */
/* Objects of HTTP servers and of buckets (S3, Google Cloud Storage, Azure), with the crate `object_store`. Implemented
 * in Rust (codecs/remote/src).
 *
 * An address is http://, https://, s3://BUCKET/KEY, gs://BUCKET/KEY or az://CONTAINER/KEY. Keys are not
 * percent-encoded. Credentials of buckets come from the environment (AWS_*, GOOGLE_*, AZURE_*). Functions return a
 * psr_status; if it is not PSR_DONE, `detail` describes the failure in some words, without the address and without
 * credentials. Any number of threads may call the functions at the same time. A request that a server answers with 5xx
 * or 429, or not at all, is repeated for about half a minute. */
#ifndef POINTSWEEP_REMOTE_H
#define POINTSWEEP_REMOTE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum psr_status {
  PSR_DONE = 0,
  PSR_NOT_FOUND = 1,
  PSR_DENIED = 2,       /* 401, 403, or there are no credentials */
  PSR_EXISTS = 3,       /* the object exists and was not to be overwritten */
  PSR_CHANGED = 4,      /* the object has another version than the expected version */
  PSR_NO_RANGES = 5,    /* the server sends only whole files */
  PSR_UNAVAILABLE = 6,  /* 5xx, 429, no connection or no answer, after retries */
  PSR_TRUNCATED = 7,    /* the answer ends too early, after retries */
  PSR_TLS = 8,          /* the certificate of the server is not trusted */
  PSR_NOT_POSSIBLE = 9, /* the server, or the scheme of the address, does not support the operation */
  PSR_WRONG_ADDRESS = 10,
  PSR_FILE = 11, /* a local file cannot be read */
  PSR_CANCELLED = 12,
  PSR_OTHER = 13
} psr_status;

typedef struct psr_detail {
  char text[256]; /* with a final 0 */
} psr_detail;

/* The properties that distinguish versions of an object. */
typedef struct psr_version {
  uint64_t size;
  int64_t seconds;      /* time of the last change, since 1970; 0 if the server does not state it */
  uint32_t nanoseconds; /* nanoseconds of the last change, after `seconds` */
  char etag[116];       /* with a final 0; empty if there is none, or if it is longer */
} psr_version;

/* Sets a function that returns nonzero if the work of the thread that calls it is cancelled. Requests call the function
 * about every 100 ms, and then end with PSR_CANCELLED. */
void psr_set_cancelled(int (*cancelled)(void));

/* Returns the current version of an object. */
int psr_look(const char* address, psr_version* version, psr_detail* detail);
/* Reads up to `bytes` bytes from `offset` on, fewer at the end of the object. Sets the number of bytes read and the
 * version of the object. `expected`: the version that the object must have; null for any version. */
int psr_read(const char* address, const psr_version* expected, uint64_t offset, uint8_t* into, size_t bytes,
             size_t* read, psr_version* version, psr_detail* detail);

/* A function that gets the key of an object, without the folder, and its size. */
typedef void (*psr_visit)(void* context, const char* key, uint64_t size);
/* Calls `visit` for each object in a folder, whose address ends in a slash, and in the folders below if `recursive`. */
int psr_list(const char* folder, int recursive, psr_visit visit, void* context, psr_detail* detail);

/* Makes an object from a local file, in several parts if it is large. The object is visible only when complete. */
int psr_put_file(const char* address, const char* path, int overwrite, psr_detail* detail);
int psr_put(const char* address, const uint8_t* data, size_t bytes, int overwrite, psr_detail* detail);
/* Removes an object, if there is one. */
int psr_remove(const char* address, psr_detail* detail);

#ifdef __cplusplus
}
#endif
#endif
