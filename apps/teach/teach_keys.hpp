#pragma once

#include <optional>
#include <string>

#include "apps/teach/teach_session.hpp"

namespace clearway {

/// What a key does in this state: one key begins and ends a stroke. Empty for a key that does nothing.
std::optional<TeachAction> action_of_key(int key, TeachState state);

/// The keys that do something in this state, for the strip: "space: stop painting, u: undo, q: quit".
std::string keys_of(TeachState state);

}  // namespace clearway
