#pragma once

#include "apps/query/query.hpp"

namespace clearway {

/// When a leg of `plan` was not solved, looks where painting more would connect its ends (see
/// planning/advice/paint_advice.hpp): the spheres go to `plan.paint`, the sentence to the leg's explanation.
void advise(const Query& query, Plan& plan);

}  // namespace clearway
