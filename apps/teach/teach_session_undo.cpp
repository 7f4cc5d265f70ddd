// How a session takes back what was done: the last action, or the last stroke alone.
#include <algorithm>
#include <stdexcept>

#include "apps/teach/teach_session.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

void TeachSession::remember(const std::string& what, std::optional<int> stroke) {
  constexpr std::size_t most_undos = 1000;
  if (undos_.size() == most_undos) undos_.pop_front();
  undos_.push_back({what, choice_, stroke});
}

void TeachSession::undo(std::string& remark) {
  if (undos_.empty()) refuse("nothing was done");
  if (doing_ == Doing::painting || doing_ == Doing::erasing) end_stroke();
  if (doing_ == Doing::marking) doing_ = Doing::nothing;
  Undo last = std::move(undos_.back());
  undos_.pop_back();
  if (last.what == approval_word) plans_[*last.before.plan].is_approved = false;
  if (last.stroke) {
    map_->undo_stroke(*last.stroke);
    ++other_changes_;
  }
  if (last.adds_volume && map_->remove_last_volume()) ++other_changes_;
  choice_ = std::move(last.before);
  use_robot(choice_.robot, now_);
  remark = last.what + " is undone";
}

bool TeachSession::has_strokes() const {
  return std::any_of(undos_.begin(), undos_.end(), [](const Undo& done) { return done.stroke.has_value(); });
}

/// What was chosen since stays. What was planned since rests on the stroke, and goes with it.
void TeachSession::undo_stroke(std::string& remark) {
  const auto last =
      std::find_if(undos_.rbegin(), undos_.rend(), [](const Undo& done) { return done.stroke.has_value(); });
  if (last == undos_.rend()) refuse("no stroke was made, or none is left");
  const std::size_t number = undos_.size() - 1 - static_cast<std::size_t>(last - undos_.rbegin());
  if (doing_ == Doing::painting || doing_ == Doing::erasing) end_stroke();
  const Undo stroke = undos_[number];
  remark = stroke.what + " is undone" + withdraw_plans(number);
  undos_.erase(undos_.begin() + static_cast<std::ptrdiff_t>(number));
  map_->undo_stroke(*stroke.stroke);
  ++other_changes_;
  remark += blocked_places();
}

/// Takes back what was planned and approved after undos_[stroke]. Returns a clause about the approvals.
std::string TeachSession::withdraw_plans(std::size_t stroke) {
  const auto after = undos_.begin() + static_cast<std::ptrdiff_t>(stroke) + 1;
  std::string clause;
  for (auto done = after; done != undos_.end(); ++done) {
    if (done->what != approval_word) continue;
    TaughtPlan& plan = plans_[*done->before.plan];
    plan.is_approved = false;
    clause += ", and the approval of " + quote(plan.name);
  }
  undos_.erase(
      std::remove_if(after, undos_.end(),
                     [](const Undo& done) { return done.what == approval_word || done.what == plan_word; }),
      undos_.end());
  const bool had_plan = choice_.plan.has_value();
  for (std::size_t i = stroke + 1; i < undos_.size(); ++i) undos_[i].before.forget_plan();
  choice_.forget_plan();
  if (had_plan) choice_.outdated = "a stroke was undone";
  return clause;
}

/// A clause about the start and the goals that are not free, now that the map has changed; empty for none.
std::string TeachSession::blocked_places() {
  std::string clause;
  const auto look = [&](const TaughtPlace& place, const std::string& what) {
    try {
      if (const Verdict verdict = check(place.q, place.held); !verdict.is_free())
        clause += "; " + what + " is not free any more: " + verdict.sentence();
    } catch (const std::invalid_argument& error) {  // the stroke is undone all the same
      clause += "; " + what + " cannot be looked at: " + error.what();
    }
  };
  if (choice_.start) look(*choice_.start, "the start");
  for (const TaughtPlace& via : choice_.vias) look(via, "a goal on the way");
  if (choice_.goal) look(*choice_.goal, "the goal");
  return clause;
}

}  // namespace clearway
