// The planar plant of several designs side by side, over fixed steps. Numbers go in and out as rows of lanes() doubles,
// one per design.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "outputs.hpp"

namespace giveway::batch {

// A design where it starts.
struct LaneStart {
    plant::Parameters<double> parameters;
    plant::StateVector<double> state;
    plant::Modes<double> modes;
    plant::Inputs<double> inputs;
    double first_contact_s; // negative: none yet
};

// The parameters that select code, that is every choice and count: designs side by side share them.
class Structure {
public:
    explicit Structure(const plant::Parameters<double> &p) {
        std::size_t used = 0;
        const auto keep = [&](const char *, const auto &value) {
            using Value = std::remove_cvref_t<decltype(value)>;
            if constexpr (std::is_integral_v<Value> || std::is_enum_v<Value>) {
                choices_.at(used++) = static_cast<std::int32_t>(value);
            }
        };
        plant::visit_parameters(keep, p);
        keep("outline_body", p.outline_body);
        keep("outline_wheels", p.outline_wheels);
    }
    friend auto operator<=>(const Structure &, const Structure &) = default;

private:
    std::array<std::int32_t, 24> choices_{};
};

class LanePlant {
public:
    virtual ~LanePlant() = default;
    [[nodiscard]] virtual int lanes() const = 0;

    // lanes() designs of one structure, at time 0.
    virtual void start(const LaneStart *designs) = 0;
    // New inputs from now on: pushes are rows in the order of plant::Inputs.
    virtual void set_motor_torques(const double *rows) = 0;
    virtual void set_pushes(const double *rows) = 0;
    // `count` steps of `step_s`.
    virtual void advance(int count, double step_s) = 0;
    // Brings modes and observed outputs up to the present state.
    virtual void observe() = 0;

    // Rows, in the order of StateVector, Modes and Outputs.
    [[nodiscard]] virtual const double *state() const = 0;
    [[nodiscard]] virtual const double *modes() const = 0;
    [[nodiscard]] virtual const double *outputs() const = 0;
    [[nodiscard]] virtual const double *first_contact_s() const = 0; // one row; negative: none yet
    [[nodiscard]] virtual const double *events() const = 0;          // one row: instants at which a mode changed
    [[nodiscard]] virtual const double *last_event_s() const = 0;    // one row
};

// nullptr when memory is short. 4 lanes need AVX2, 8 lanes AVX-512 F, DQ and VL.
[[nodiscard]] LanePlant *new_lane_plant_1();
[[nodiscard]] LanePlant *new_lane_plant_4();
[[nodiscard]] LanePlant *new_lane_plant_8();

} // namespace giveway::batch
