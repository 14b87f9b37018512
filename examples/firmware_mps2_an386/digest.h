/* FNV-1a over the bits of outputs, least significant byte first on every machine. All NaNs count as one. */
#ifndef DIGEST_H
#define DIGEST_H

#include "giveway/gw_controller.h"

typedef struct {
    uint64_t value;
} digest_t;

digest_t digest_begin(void);
void digest_u32(digest_t *digest, uint32_t word);
void digest_i32(digest_t *digest, int32_t word);
void digest_bool(digest_t *digest, bool truth);
void digest_real(digest_t *digest, gw_real_t x);
void digest_reals(digest_t *digest, const gw_real_t *x, uint32_t count);
void digest_vector(digest_t *digest, gw_vector_t vector);
void digest_twist(digest_t *digest, gw_twist_t twist);
void digest_wrench(digest_t *digest, gw_wrench_t wrench);
void digest_pose(digest_t *digest, gw_pose_t pose);
void digest_contact(digest_t *digest, const gw_contact_estimate_t *contact);
/* One step of the controller: what its FMU puts out, in the order of the FMU's variable table. */
void digest_controller(digest_t *digest, gw_status_t status, const gw_controller_output_t *output);

#endif
