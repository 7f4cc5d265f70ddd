#pragma once

#include <string_view>

namespace clearway {

/// The report page without its data: the HTML that apps/viewer builds, embedded in the program.
std::string_view report_template();

}  // namespace clearway
