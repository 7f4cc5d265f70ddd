#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/teach/teach_session.hpp"

namespace clearway {

/// What a key does in this state: one key begins and ends a stroke. Empty for a key that does nothing.
std::optional<TeachAction> action_of_key(int key, TeachState state);

/// What a key does now that a file of keys gives: where the ball marks an object, that of `object` ends the
/// stroke; that of a load which is held lets go of it. Empty for other keys.
std::optional<TeachEvent> event_of_key(int key, const std::vector<TeachKey>& keys,
                                       const TeachSession& session);

/// These keys for the strip: "1: robot arm6, 2: volume shelf".
std::string words_of(const std::vector<TeachKey>& keys);

/// What a session has that keys can be for.
struct KeyOffer {
  bool probe = true;     ///< whose ball paints, erases and marks
  bool objects = false;  ///< that are marked and may be picked
  bool place = false;    ///< is wanted for the one that is picked
  bool load = false;     ///< is held and may be let go
  bool robot = false;    ///< is led, and may have other arm configurations
  bool stroke = false;   ///< may be taken back
};

/// The keys that do something in this state, for the strip: "space: stop painting, u: undo, q: quit".
std::string keys_of(TeachState state, const KeyOffer& offer);

}  // namespace clearway
