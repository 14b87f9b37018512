#include "parts.h"

static gw_contact_t contact;
static gw_contact_config_t config;

static void part_init(void)
{
    draw_contact_config(&config);
    disturb_contact(&contact);
    if (gw_contact_init(&contact, &config) == GW_STATUS_OK) { /* the outline is convex */
        hold_contact(&contact);
    }
}

static void part_step(void)
{
    const gw_wrench_t wrench = {any_real(), any_real(), any_real()};
    const gw_wrench_sigma_t sigma = {any_real(), any_real()};
    gw_contact_estimate_t estimate;
    draw_contact(&contact);
    (void)gw_contact_locate(&contact, wrench, sigma, &estimate);
    hold_contact(&contact);
    hold_contact_estimate(&estimate);
    (void)gw_contact_invariant_holds(&contact);
}

static void part_refusals(void)
{
    const gw_wrench_t wrench = {any_real(), any_real(), any_real()};
    const gw_wrench_sigma_t sigma = {any_real(), any_real()};
    gw_contact_estimate_t estimate;
    draw_contact_config(&config);
    config.vertex_count = draw_count(GW_OUTLINE_VERTEX_MAX + 1U, UINT32_MAX);
    (void)gw_contact_init(any_flag() ? &contact : NULL, any_flag() ? &config : NULL);
    contact.initialised = false;
    (void)gw_contact_locate(any_flag() ? &contact : NULL, wrench, sigma, any_flag() ? &estimate : NULL);
    disturb_contact(&contact);
    /* a larger number is refused before the corners are read, but Eva cannot know this */
    contact.config.vertex_count = GW_OUTLINE_VERTEX_MAX;
    (void)gw_contact_invariant_holds(any_flag() ? &contact : NULL);
}
