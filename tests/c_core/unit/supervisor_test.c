#include "unit.h"

static const gw_supervisor_config_t rejoins = {R(0.005), 2U, GW_AFTER_SETTLED_REJOIN, R(0.0002), R(0.0005)};

static gw_supervisor_t in_mode(gw_mode_t mode)
{
    gw_supervisor_t supervisor;
    CHECK_STATUS(gw_supervisor_init(&supervisor, &rejoins), GW_STATUS_OK);
    CHECK(gw_supervisor_invariant_holds(&supervisor));
    CHECK(supervisor.mode == GW_MODE_TARING);
    supervisor.mode = mode;
    return supervisor;
}

/* No event, with good sensors and a valid plan. */
static const gw_supervisor_events_t quiet_tick = {true, false, false, false, false, false, false, true};

static gw_mode_t step(gw_supervisor_t *supervisor, const gw_supervisor_events_t *events)
{
    const gw_mode_t mode = gw_supervisor_step(supervisor, events);
    CHECK(gw_supervisor_invariant_holds(supervisor));
    CHECK(supervisor->mode == mode);
    return mode;
}

static void bad_arguments_are_refused(void)
{
    gw_supervisor_t supervisor = in_mode(GW_MODE_TRACKING);
    gw_supervisor_config_t bad = rejoins;
    bad.settled_ticks = 0U;
    CHECK_STATUS(gw_supervisor_init(NULL, &rejoins), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_supervisor_init(&supervisor, NULL), GW_STATUS_NULL_POINTER);
    CHECK(gw_supervisor_step(NULL, &quiet_tick) == GW_MODE_FAULT);
    CHECK(gw_supervisor_step(&supervisor, NULL) == GW_MODE_FAULT);
    CHECK_STATUS(gw_supervisor_init(&supervisor, &bad), GW_STATUS_CONFIG_INVALID);
    CHECK(gw_supervisor_step(&supervisor, &quiet_tick) == GW_MODE_FAULT);
}

/* Every mode, every event that may end it. */
static void each_event_leads_where_the_table_says(void)
{
    const gw_supervisor_events_t nothing = quiet_tick;
    gw_supervisor_events_t bad = quiet_tick;
    gw_supervisor_events_t stop = quiet_tick;
    gw_supervisor_events_t retare = quiet_tick;
    gw_supervisor_events_t tared = quiet_tick;
    gw_supervisor_events_t hit = quiet_tick;
    gw_supervisor_events_t arrived = quiet_tick;
    gw_supervisor_events_t all_bad = quiet_tick;
    bad.sensors_good = false;
    stop.stop_request = true;
    retare.tare_accepted = true;
    tared.tare_done = true;
    hit.hit = true;
    arrived.on_path = true;
    all_bad.sensors_good = false;
    all_bad.stop_request = true;
    all_bad.hit = true;
    const struct {
        gw_mode_t before;
        const gw_supervisor_events_t *events;
        gw_mode_t after;
    } rows[] = {
        {GW_MODE_TARING, &nothing, GW_MODE_TARING},
        {GW_MODE_TARING, &tared, GW_MODE_TRACKING},
        {GW_MODE_TARING, &hit, GW_MODE_TARING},
        {GW_MODE_TARING, &bad, GW_MODE_FAULT},
        {GW_MODE_TARING, &stop, GW_MODE_STOPPED},
        {GW_MODE_TRACKING, &nothing, GW_MODE_TRACKING},
        {GW_MODE_TRACKING, &retare, GW_MODE_TARING},
        {GW_MODE_TRACKING, &hit, GW_MODE_REACTING},
        {GW_MODE_TRACKING, &stop, GW_MODE_STOPPED},
        {GW_MODE_TRACKING, &bad, GW_MODE_FAULT},
        {GW_MODE_TRACKING, &all_bad, GW_MODE_FAULT},
        {GW_MODE_REACTING, &nothing, GW_MODE_REACTING},
        {GW_MODE_REACTING, &hit, GW_MODE_REACTING},
        {GW_MODE_SETTLED, &nothing, GW_MODE_REJOINING},
        {GW_MODE_SETTLED, &retare, GW_MODE_TARING},
        {GW_MODE_SETTLED, &hit, GW_MODE_REACTING},
        {GW_MODE_REJOINING, &nothing, GW_MODE_REJOINING},
        {GW_MODE_REJOINING, &arrived, GW_MODE_TRACKING},
        {GW_MODE_REJOINING, &hit, GW_MODE_REACTING},
        {GW_MODE_STOPPED, &stop, GW_MODE_STOPPED},
        {GW_MODE_STOPPED, &nothing, GW_MODE_TRACKING},
        {GW_MODE_STOPPED, &hit, GW_MODE_TRACKING},
        {GW_MODE_FAULT, &bad, GW_MODE_FAULT},
        {GW_MODE_FAULT, &nothing, GW_MODE_TRACKING},
        {GW_MODE_FAULT, &hit, GW_MODE_TRACKING},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_supervisor_t supervisor = in_mode(rows[i].before);
        unit_row(i);
        CHECK(step(&supervisor, rows[i].events) == rows[i].after);
    }
}

/* After an interruption: the path is rejoined, an escape is abandoned, a tare is taken again. */
static void an_interruption_leads_back(void)
{
    const struct {
        gw_mode_t before;
        gw_mode_t after;
    } rows[] = {
        {GW_MODE_TARING, GW_MODE_TARING},       {GW_MODE_TRACKING, GW_MODE_REJOINING},
        {GW_MODE_REACTING, GW_MODE_REACTING},   {GW_MODE_SETTLED, GW_MODE_SETTLED},
        {GW_MODE_REJOINING, GW_MODE_REJOINING},
    };
    gw_supervisor_events_t stop = quiet_tick;
    gw_supervisor_events_t bad = quiet_tick;
    stop.stop_request = true;
    bad.sensors_good = false;
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_supervisor_t supervisor = in_mode(rows[i].before);
        unit_row(i);
        CHECK(step(&supervisor, &stop) == GW_MODE_STOPPED);
        CHECK(step(&supervisor, &bad) == GW_MODE_FAULT);
        CHECK(step(&supervisor, &stop) == GW_MODE_STOPPED);
        CHECK(step(&supervisor, &quiet_tick) == rows[i].after);
    }
}

/* A tare asked for in SETTLED leads back to SETTLED, also when it was interrupted. */
static void a_tare_leads_back_to_where_it_was_asked_for(void)
{
    gw_supervisor_t supervisor = in_mode(GW_MODE_SETTLED);
    gw_supervisor_events_t event = quiet_tick;
    event.tare_accepted = true;
    CHECK(step(&supervisor, &event) == GW_MODE_TARING);
    event = quiet_tick;
    event.stop_request = true;
    CHECK(step(&supervisor, &event) == GW_MODE_STOPPED);
    CHECK(step(&supervisor, &quiet_tick) == GW_MODE_TARING);
    event = quiet_tick;
    event.tare_done = true;
    CHECK(step(&supervisor, &event) == GW_MODE_SETTLED);
}

/* Two quiet ticks in a row end a reaction; a loud one starts the count anew. */
static void quiet_ends_a_reaction(void)
{
    gw_supervisor_t supervisor = in_mode(GW_MODE_REACTING);
    gw_supervisor_events_t quiet = quiet_tick;
    quiet.quiet = true;
    CHECK(step(&supervisor, &quiet) == GW_MODE_REACTING);
    CHECK(step(&supervisor, &quiet_tick) == GW_MODE_REACTING);
    CHECK(step(&supervisor, &quiet) == GW_MODE_REACTING);
    CHECK(step(&supervisor, &quiet) == GW_MODE_SETTLED);
    CHECK(supervisor.quiet_ticks == 0U);
}

static void quiet_ends_nothing_but_a_reaction(void)
{
    gw_supervisor_t supervisor = in_mode(GW_MODE_TRACKING);
    gw_supervisor_events_t quiet = quiet_tick;
    supervisor.config.settled_ticks = 1U;
    quiet.quiet = true;
    CHECK(step(&supervisor, &quiet) == GW_MODE_TRACKING);
}

static void settled_may_hold_for_ever(void)
{
    gw_supervisor_t supervisor = in_mode(GW_MODE_SETTLED);
    supervisor.config.after_settled = GW_AFTER_SETTLED_HOLD;
    for (uint32_t tick = 0U; tick < 1000U; tick++) {
        CHECK(step(&supervisor, &quiet_tick) == GW_MODE_SETTLED);
    }
}

static void the_path_clock_runs_in_tracking_on_a_valid_plan_only(void)
{
    gw_supervisor_t supervisor = in_mode(GW_MODE_TRACKING);
    gw_supervisor_events_t no_plan = quiet_tick;
    no_plan.plan_valid = false;
    (void)step(&supervisor, &quiet_tick);
    CHECK(supervisor.path_ticks == 1U);
    (void)step(&supervisor, &no_plan);
    CHECK(supervisor.path_ticks == 1U);
    supervisor.path_ticks = GW_TICK_MASK;
    (void)step(&supervisor, &quiet_tick);
    CHECK(supervisor.path_ticks == 0U);
    supervisor.mode = GW_MODE_REJOINING;
    (void)step(&supervisor, &quiet_tick);
    CHECK(supervisor.path_ticks == 0U);
}

/* An invalid mode after a flipped bit: it continues as after an interruption. */
static void a_corrupt_mode_leads_back_to_a_known_one(void)
{
    gw_supervisor_t supervisor = in_mode(GW_MODE_TRACKING);
    const uint32_t no_mode = 7U;
    supervisor.mode = (gw_mode_t)no_mode;
    CHECK(!gw_supervisor_invariant_holds(&supervisor));
    CHECK(step(&supervisor, &quiet_tick) == GW_MODE_TRACKING);
}

static void the_invariant_sees_every_member(void)
{
    const uint32_t no_mode = 7U;
    gw_supervisor_t most = in_mode(GW_MODE_REJOINING);
    gw_supervisor_t bad[6];
    most.resume = GW_MODE_REJOINING;
    most.quiet_ticks = rejoins.settled_ticks;
    most.path_ticks = GW_TICK_MASK;
    CHECK(gw_supervisor_invariant_holds(&most));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        bad[i] = in_mode(GW_MODE_TRACKING);
    }
    bad[0].initialised = false;
    bad[1].config.settled_speed_mps = GW_ZERO;
    bad[2].resume = (gw_mode_t)no_mode;
    bad[3].quiet_ticks = 3U;
    bad[4].path_ticks = GW_TICK_MASK + 1U;
    bad[5].resume = GW_MODE_STOPPED;
    CHECK(!gw_supervisor_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        unit_row(i);
        CHECK(!gw_supervisor_invariant_holds(&bad[i]));
    }
}

void suite_supervisor(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("each_event_leads_where_the_table_says", each_event_leads_where_the_table_says);
    unit_run("an_interruption_leads_back", an_interruption_leads_back);
    unit_run("a_tare_leads_back_to_where_it_was_asked_for", a_tare_leads_back_to_where_it_was_asked_for);
    unit_run("quiet_ends_a_reaction", quiet_ends_a_reaction);
    unit_run("quiet_ends_nothing_but_a_reaction", quiet_ends_nothing_but_a_reaction);
    unit_run("settled_may_hold_for_ever", settled_may_hold_for_ever);
    unit_run("the_path_clock_runs_in_tracking_on_a_valid_plan_only",
             the_path_clock_runs_in_tracking_on_a_valid_plan_only);
    unit_run("a_corrupt_mode_leads_back_to_a_known_one", a_corrupt_mode_leads_back_to_a_known_one);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
