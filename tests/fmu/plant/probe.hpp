// The types that the C functions of this folder's library pass around.
#pragma once

#include "parameters.hpp"

struct Probe {
    giveway::plant::Parameters<double> p = {};
    giveway::plant::Derived<double> d = {};
    char error[512] = "";
};

#define EXPORT extern "C" __attribute__((visibility("default")))
