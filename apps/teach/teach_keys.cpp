#include "apps/teach/teach_keys.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

struct Key {
  char key;
  TeachAction action;
  std::string_view word;
};

constexpr std::array<Key, 18> keys = {{{' ', TeachAction::paint_on, "paint"},
                                       {'e', TeachAction::erase_on, "erase"},
                                       {'b', TeachAction::branch, "other arm"},
                                       {'s', TeachAction::start, "start"},
                                       {'v', TeachAction::via, "via"},
                                       {'g', TeachAction::goal, "goal"},
                                       {'c', TeachAction::clear, "clear"},
                                       {'p', TeachAction::plan, "plan"},
                                       {'l', TeachAction::play, "play"},
                                       {'a', TeachAction::approve, "approve"},
                                       {'o', TeachAction::object, "object"},
                                       {'k', TeachAction::pick, "pick"},
                                       {'d', TeachAction::place, "place"},
                                       {'x', TeachAction::detach, "detach"},
                                       {'u', TeachAction::undo, "undo"},
                                       {'z', TeachAction::undo_stroke, "undo stroke"},
                                       {'w', TeachAction::save, "save"},
                                       {'q', TeachAction::quit, "quit"}}};

std::string spelled(char key) { return key == ' ' ? "space" : std::string(1, key); }

bool uses_ball(TeachAction action) {
  return action == TeachAction::paint_on || action == TeachAction::erase_on || action == TeachAction::object;
}

/// Whether it makes sense to offer the action; others are refused with their reason when the key is pressed.
bool is_offered(TeachAction action, TeachState state, const KeyOffer& offer) {
  if (uses_ball(action) && !offer.probe) return false;
  const bool strokes =
      state == TeachState::painting || state == TeachState::erasing || state == TeachState::marking;
  const bool has_plan = state == TeachState::planned || state == TeachState::playing;
  switch (action) {
    case TeachAction::quit:
      return true;
    case TeachAction::save:
      return state == TeachState::ready || state == TeachState::approved;
    case TeachAction::undo:
      return state != TeachState::planning;
    case TeachAction::undo_stroke:
      return offer.stroke && state != TeachState::marking && state != TeachState::planning;
    case TeachAction::play:
      return has_plan || state == TeachState::approved;
    case TeachAction::approve:
      return has_plan;
    case TeachAction::pick:
      return state == TeachState::selecting && offer.objects && !offer.place;
    case TeachAction::place:
      return state == TeachState::selecting && offer.place;
    case TeachAction::detach:
      return offer.load && !strokes && state != TeachState::planning && state != TeachState::playing;
    case TeachAction::object:
      return state == TeachState::ready || state == TeachState::planned || state == TeachState::approved;
    case TeachAction::via:
    case TeachAction::goal:
    case TeachAction::clear:
    case TeachAction::plan:
      return state == TeachState::selecting;
    case TeachAction::branch:
      if (!offer.robot) return false;
      [[fallthrough]];
    default:
      return !strokes && state != TeachState::planning && state != TeachState::playing;
  }
}

}  // namespace

std::optional<TeachAction> action_of_key(int key, TeachState state) {
  constexpr int escape = 27;
  if (key == escape) return TeachAction::quit;
  if (key == ' ' && state == TeachState::painting) return TeachAction::paint_off;
  if (key == 'e' && state == TeachState::erasing) return TeachAction::erase_off;
  if (key == 'o' && state == TeachState::marking) return TeachAction::object_off;
  for (const Key& known : keys)
    if (known.key == key) return known.action;
  return std::nullopt;
}

std::optional<TeachEvent> event_of_key(int key, const std::vector<TeachKey>& own,
                                       const TeachSession& session) {
  const auto found =
      std::find_if(own.begin(), own.end(), [&](const TeachKey& one) { return one.key == key; });
  if (found == own.end()) return std::nullopt;
  TeachEvent event = found->event;
  if (event.action == TeachAction::object && session.state() == TeachState::marking) {
    event = {};
    event.action = TeachAction::object_off;
  }
  if (event.action == TeachAction::attach && holds(session.held_loads(), event.name)) {
    event.action = TeachAction::detach;
    event.load.reset();
  }
  return event;
}

std::string words_of(const std::vector<TeachKey>& own) {
  std::string text;
  for (const TeachKey& key : own) {
    const TeachEvent& event = key.event;
    const std::string& name = event.action == TeachAction::robot ? event.robot.robot : event.name;
    text += (text.empty() ? "" : ", ") + spelled(key.key) + ": " + std::string(to_string(event.action)) +
            (name.empty() ? "" : " " + shortened(name));
  }
  return text;
}

std::string keys_of(TeachState state, const KeyOffer& offer) {
  if (state == TeachState::ended) return {};
  std::string text;
  if (state == TeachState::painting) text = "space: stop painting";
  if (state == TeachState::erasing) text = "e: stop erasing";
  if (state == TeachState::marking) text = "o: stop marking";
  for (const Key& key : keys)
    if (is_offered(key.action, state, offer))
      text += (text.empty() ? "" : ", ") + spelled(key.key) + ": " + std::string(key.word);
  return text;
}

}  // namespace clearway
