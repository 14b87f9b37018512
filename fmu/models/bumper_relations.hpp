// What a bumper's law asks of several of its parameters together; the shell has checked every single range.
#pragma once

#include <algorithm>
#include <cstdio>

#include "bumper_laws.hpp"
#include "model.hpp"

namespace giveway {

namespace detail {

inline bool refuse(Message &message, const char *name, double value, const char *rule, double bound) {
    std::snprintf(message.text, sizeof message.text, "%s = %.9g is not allowed: it must be %s %.9g", name, value, rule,
                  bound);
    return false;
}

inline bool refuse(Message &message, const char *name, int index, double value, const char *rule, double bound) {
    char element[64];
    std::snprintf(element, sizeof element, "%s[%d]", name, index);
    return refuse(message, element, value, rule, bound);
}

// The three forces have to rise all the way to the end of the travel.
inline bool check_foam(const plant::Parameters<double> &p, Message &message) {
    const double greatest = 0.95 * p.bumper_foam_thickness;
    if (p.bumper_travel > greatest) {
        return refuse(message, "bumper.travel", p.bumper_travel, "at most 0.95 bumper.foam_thickness =", greatest);
    }
    const auto curve = plant::Foam::loading(p);
    const double end = p.bumper_travel / p.bumper_foam_thickness;
    double place = curve.slope(end) < curve.slope(0.0) ? end : 0.0; // of the lowest slope
    if (curve.third > 0.0) {
        place = std::clamp(curve.second / (-3.0 * curve.third), 0.0, end);
    }
    if (curve.slope(place) <= 0.0) {
        return refuse(message, "bumper.foam_force_50", p.bumper_foam_force_50,
                      "such that the curve through bumper.foam_force_25, _50 and _75 rises; it falls where the "
                      "compression over the thickness is",
                      place);
    }
    return true;
}

inline bool check_gas(const plant::Parameters<double> &p, Message &message) {
    const double greatest = 0.95 * p.bumper_gas_length;
    return p.bumper_travel <= greatest ||
           refuse(message, "bumper.travel", p.bumper_travel, "at most 0.95 bumper.gas_length =", greatest);
}

inline bool check_series(const plant::Parameters<double> &p, Message &message) {
    const double solid = p.bumper_preload + p.bumper_spring_rate * p.bumper_first_travel;
    return p.bumper_second_preload <= solid ||
           refuse(message, "bumper.second_preload", p.bumper_second_preload,
                  "at most the force at which the first spring is solid, bumper.preload + bumper.spring_rate "
                  "bumper.first_travel =",
                  solid);
}

// Rising travels from 0, rising speeds with a 0 among them, and forces that do not fall with the speed: such a table
// takes energy and gives none.
inline bool check_table(const plant::Parameters<double> &p, Message &message) {
    const auto &travel = p.bumper_table_travel;
    const auto &speed = p.bumper_table_speed;
    const int rows = p.bumper_table_rows;
    const int columns = p.bumper_table_columns;
    const auto at = [](const auto &list, int i) -> double { return list[static_cast<std::size_t>(i)]; };
    if (at(travel, 0) != 0.0) {
        return refuse(message, "bumper.table_travel", 0, at(travel, 0), "full extension,", 0.0);
    }
    for (int i = 1; i < rows; ++i) {
        if (at(travel, i) <= at(travel, i - 1)) {
            return refuse(message, "bumper.table_travel", i, at(travel, i), "greater than the one before,",
                          at(travel, i - 1));
        }
    }
    if (p.bumper_travel > at(travel, rows - 1)) {
        return refuse(message, "bumper.travel", p.bumper_travel,
                      "at most the last bumper.table_travel in use =", at(travel, rows - 1));
    }
    bool rest = false;
    for (int j = 0; j < columns; ++j) {
        rest = rest || at(speed, j) == 0.0;
        if (j > 0 && at(speed, j) <= at(speed, j - 1)) {
            return refuse(message, "bumper.table_speed", j, at(speed, j), "greater than the one before,",
                          at(speed, j - 1));
        }
    }
    if (!rest) {
        return refuse(message, "bumper.table_speed", 0, at(speed, 0), "such that one of the speeds in use is", 0.0);
    }
    const int width = static_cast<int>(plant::ForceTable::columns);
    for (int i = 0; i < rows; ++i) {
        for (int j = 1; j < columns; ++j) {
            const int element = width * i + j;
            if (at(p.bumper_table_force, element) < at(p.bumper_table_force, element - 1)) {
                return refuse(message, "bumper.table_force", element, at(p.bumper_table_force, element),
                              "at least the force at the speed before, or the bumper would create energy,",
                              at(p.bumper_table_force, element - 1));
            }
        }
    }
    return true;
}

} // namespace detail

inline bool check_bumper(const plant::Parameters<double> &p, Message &message) {
    switch (p.bumper_kind) {
    case plant::BumperKind::foam:
        return detail::check_foam(p, message);
    case plant::BumperKind::gas:
        return detail::check_gas(p, message);
    case plant::BumperKind::series:
        return detail::check_series(p, message);
    case plant::BumperKind::table:
        return detail::check_table(p, message);
    case plant::BumperKind::none:
    case plant::BumperKind::spring:
    case plant::BumperKind::magnetic:
    case plant::BumperKind::damper:
    case plant::BumperKind::lever:
        break;
    }
    return true;
}

} // namespace giveway
