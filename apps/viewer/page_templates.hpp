#pragma once

#include <string_view>

namespace clearway {

// The pages without their data: the HTML that apps/viewer builds, embedded in the program.

/// Of one recording (`replay`).
std::string_view report_template();

/// Of one suite (`compare`).
std::string_view compare_template();

}  // namespace clearway
