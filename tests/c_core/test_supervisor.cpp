#include "support.hpp"

namespace {

gw_supervisor_config_t config_of(std::uint32_t after_settled) {
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    config.supervisor.settled_ticks = 5;
    config.supervisor.after_settled = after_settled;
    return config.supervisor;
}

class Supervised {
public:
    explicit Supervised(std::uint32_t after_settled) {
        const auto config = config_of(after_settled);
        EXPECT_EQ(gw_supervisor_init(&s, &config), GW_STATUS_OK);
        events.sensors_good = true;
        events.plan_valid = true;
    }
    gw_mode_t step() {
        const gw_mode_t mode = gw_supervisor_step(&s, &events);
        EXPECT_TRUE(gw_supervisor_invariant_holds(&s));
        return mode;
    }
    gw_mode_t once(bool gw_supervisor_events_t::*event) {
        events.*event = true;
        const gw_mode_t mode = step();
        events.*event = false;
        return mode;
    }
    void track() {
        EXPECT_EQ(step(), GW_MODE_TARING);
        EXPECT_EQ(once(&gw_supervisor_events_t::tare_done), GW_MODE_TRACKING);
    }
    // From REACTING.
    void settle() {
        events.quiet = true;
        for (int i = 0; i < 4; ++i) {
            EXPECT_EQ(step(), GW_MODE_REACTING);
        }
        EXPECT_EQ(step(), GW_MODE_SETTLED);
        events.quiet = false;
    }

    gw_supervisor_t s{};
    gw_supervisor_events_t events{};
};

using Event = gw_supervisor_events_t;

TEST(Supervisor, TheWholeSequenceAndItsPathClock) {
    Supervised r(GW_AFTER_SETTLED_REJOIN);
    for (int i = 0; i < 10; ++i) {
        ASSERT_EQ(r.step(), GW_MODE_TARING);
        ASSERT_EQ(r.s.path_ticks, 0U);
    }
    EXPECT_EQ(r.once(&Event::tare_done), GW_MODE_TRACKING);
    for (int i = 0; i < 9; ++i) {
        ASSERT_EQ(r.step(), GW_MODE_TRACKING);
    }
    EXPECT_EQ(r.s.path_ticks, 10U);
    r.events.plan_valid = false;
    EXPECT_EQ(r.step(), GW_MODE_TRACKING);
    r.events.plan_valid = true;
    EXPECT_EQ(r.s.path_ticks, 10U);
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING);
    // Quiet must last: an interruption starts it again.
    r.events.quiet = true;
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(r.step(), GW_MODE_REACTING);
    }
    r.events.quiet = false;
    ASSERT_EQ(r.step(), GW_MODE_REACTING);
    r.settle();
    EXPECT_EQ(r.step(), GW_MODE_REJOINING);
    EXPECT_EQ(r.step(), GW_MODE_REJOINING);
    EXPECT_EQ(r.s.path_ticks, 10U);
    EXPECT_EQ(r.once(&Event::on_path), GW_MODE_TRACKING);
    EXPECT_EQ(r.s.path_ticks, 11U);
}

TEST(Supervisor, HoldsForEverIfToldSo) {
    Supervised r(GW_AFTER_SETTLED_HOLD);
    r.track();
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING);
    r.settle();
    for (int i = 0; i < 1000; ++i) {
        ASSERT_EQ(r.step(), GW_MODE_SETTLED);
    }
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING); // a new hit is still answered
}

TEST(Supervisor, ANewHitRestartsTheReaction) {
    Supervised r(GW_AFTER_SETTLED_REJOIN);
    r.track();
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING);
    r.events.quiet = true;
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(r.step(), GW_MODE_REACTING);
    }
    r.events.quiet = false;
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING);
    r.settle(); // all five ticks again
    EXPECT_EQ(r.step(), GW_MODE_REJOINING);
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING);
}

TEST(Supervisor, StopsAndFaultsInterruptAndResumeSafely) {
    for (const bool fault : {false, true}) {
        const gw_mode_t interrupted = fault ? GW_MODE_FAULT : GW_MODE_STOPPED;
        const auto interrupt = [&](Supervised &r) {
            (fault ? r.events.sensors_good : r.events.stop_request) = !fault;
            for (int i = 0; i < 7; ++i) {
                r.events.hit = i == 3; // no reaction while interrupted
                ASSERT_EQ(r.step(), interrupted);
            }
            r.events.hit = false;
            (fault ? r.events.sensors_good : r.events.stop_request) = fault;
        };
        Supervised r(GW_AFTER_SETTLED_REJOIN);
        interrupt(r);
        EXPECT_EQ(r.step(), GW_MODE_TARING);
        EXPECT_EQ(r.once(&Event::tare_done), GW_MODE_TRACKING);
        interrupt(r);
        EXPECT_EQ(r.step(), GW_MODE_REJOINING); // never straight back onto a path that may be far away
        interrupt(r);
        EXPECT_EQ(r.step(), GW_MODE_REJOINING);
        EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING);
        interrupt(r);
        EXPECT_EQ(r.step(), GW_MODE_REACTING);
        r.settle();
        interrupt(r);
        EXPECT_EQ(r.step(), GW_MODE_SETTLED);
        EXPECT_EQ(r.step(), GW_MODE_REJOINING);
    }
}

TEST(Supervisor, AFaultOutranksAStopAndAStopOutranksAHit) {
    Supervised r(GW_AFTER_SETTLED_REJOIN);
    r.track();
    r.events.hit = true;
    r.events.stop_request = true;
    EXPECT_EQ(r.step(), GW_MODE_STOPPED);
    r.events.sensors_good = false;
    EXPECT_EQ(r.step(), GW_MODE_FAULT);
    r.events.sensors_good = true;
    EXPECT_EQ(r.step(), GW_MODE_STOPPED);
}

TEST(Supervisor, ANewTareReturnsToItsMode) {
    Supervised r(GW_AFTER_SETTLED_HOLD);
    r.track();
    EXPECT_EQ(r.once(&Event::tare_accepted), GW_MODE_TARING);
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_TARING);
    EXPECT_EQ(r.once(&Event::tare_done), GW_MODE_TRACKING);
    EXPECT_EQ(r.once(&Event::hit), GW_MODE_REACTING);
    r.settle();
    EXPECT_EQ(r.once(&Event::tare_accepted), GW_MODE_TARING);
    // Interrupted by a fault: the tare is taken again, and the mode after it is kept.
    r.events.sensors_good = false;
    EXPECT_EQ(r.step(), GW_MODE_FAULT);
    r.events.sensors_good = true;
    EXPECT_EQ(r.step(), GW_MODE_TARING);
    EXPECT_EQ(r.once(&Event::tare_done), GW_MODE_SETTLED);
}

TEST(Supervisor, ThePathClockWrapsAtThirtyOneBits) {
    Supervised r(GW_AFTER_SETTLED_REJOIN);
    r.track();
    r.s.path_ticks = GW_TICK_MASK;
    EXPECT_EQ(r.step(), GW_MODE_TRACKING);
    EXPECT_EQ(r.s.path_ticks, 0U);
}

TEST(Supervisor, Refusals) {
    gw_supervisor_t s{};
    const gw_supervisor_events_t events{};
    EXPECT_EQ(gw_supervisor_step(&s, &events), GW_MODE_FAULT);
    EXPECT_EQ(gw_supervisor_step(nullptr, &events), GW_MODE_FAULT);
    auto config = config_of(0);
    ASSERT_EQ(gw_supervisor_init(&s, &config), GW_STATUS_OK);
    EXPECT_EQ(gw_supervisor_step(&s, nullptr), GW_MODE_FAULT);
    config.settled_ticks = 0;
    EXPECT_EQ(gw_supervisor_init(&s, &config), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_supervisor_step(&s, &events), GW_MODE_FAULT);
    EXPECT_EQ(gw_supervisor_init(nullptr, &config), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_supervisor_init(&s, nullptr), GW_STATUS_NULL_POINTER);
    EXPECT_FALSE(gw_supervisor_invariant_holds(&s));
    EXPECT_FALSE(gw_supervisor_invariant_holds(nullptr));
}

} // namespace
