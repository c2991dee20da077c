/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes checksums of files and of their parts. */
#ifndef EHD_SHA256_H
#define EHD_SHA256_H

#include <nettle/sha2.h>

enum { SHA256_TEXT = 2 * SHA256_DIGEST_SIZE + 1 }; // 64 hexadecimal digits and a zero

/* Writes the SHA-256 of all data added to the context, and resets the context. */
void sha256_end(struct sha256_ctx *context, char text[SHA256_TEXT]);

#endif
