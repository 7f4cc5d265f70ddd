#pragma once

#include <nlohmann/json_fwd.hpp>

namespace clearway {

/// JSON knows no NaN and no infinity: null stands for them.
nlohmann::ordered_json number_or_null(double value);

}  // namespace clearway
