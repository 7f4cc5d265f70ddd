#include "datasets/ros/left_out.hpp"

#include <algorithm>

#include "datasets/ros/wire_reader.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// The clause about messages that are left out.
std::string unusable(std::size_t count, const std::string& topic, const std::string& why) {
  return "holds " + std::to_string(count) + " message" + (count == 1 ? "" : "s") + " in topic " +
         quote(topic) + " that cannot be used: " + why;
}

}  // namespace

std::string list_of_frames(const std::vector<std::string>& frames) {
  constexpr std::size_t enough = 12;
  std::string list;
  for (std::size_t i = 0; i < std::min(frames.size(), enough); ++i)
    list += (i > 0 ? ", " : "") + quote(frames[i]);
  if (frames.size() > enough) list += " and " + std::to_string(frames.size() - enough) + " more";
  return list.empty() ? "none" : list;
}

void LeftOut::note(std::map<std::string, Missing>& kind, const std::string& topic, const std::string& first) {
  Missing& missing = kind[topic];
  if (missing.count++ == 0) missing.first = first;
}

void LeftOut::leave_out(const std::string& topic, const std::runtime_error& error) {
  const bool is_cut = dynamic_cast<const CutMessage*>(&error) != nullptr;
  const bool is_jump = dynamic_cast<const JumpedPose*>(&error) != nullptr;
  note(is_cut ? cut_ : is_jump ? jumped_ : unusable_, topic, error.what());
}

void LeftOut::note_stamp(const std::string& topic, double stamp) {
  if (stamp < 0.0)
    throw ContradictoryBag("has a message in topic " + quote(topic) + " whose stamp is " + short_text(stamp) +
                           " s: expected stamps after 1970, as of a clock that runs");
  Stamps& stamps = stamps_[topic];
  ++stamps.messages;
  stamps.missing += stamp == 0.0;
}

void LeftOut::note_unseen(const std::string& topic, const std::string& frame) { note(unseen_, topic, frame); }

void LeftOut::note_standing(const std::string& topic, const std::string& frame) {
  note(standing_, topic, frame);
}

void LeftOut::note_mounted(const std::string& topic, const std::string& frame, const MountedFrames& mounted,
                           bool is_body) {
  const std::string of = mounted.are_sensors ? "sensors" : "frames";
  note(mounted_, topic,
       quote(frame) + ", below which " + of + " are mounted up to " + short_text(mounted.farthest, 3) +
           " m from its origin (" + list_of_frames(mounted.names) + "): " +
           (is_body ? "they mark what is occupied and free nothing, as nothing says where the sensor was"
                    : "their rays are taken to begin at that origin") +
           "; `source: {bag: {fixed_frame: …, sensor_frame: " +
           (mounted.are_sensors ? mounted.names.front() : "…") +
           "}}` of the setup lets them begin where one sensor is that measured them all, `sensor_frame: " +
           frame + "` at that origin");
}

void LeftOut::note_motion(const std::string& topic, const std::string& field, double farthest) {
  Motion& motion = moved_[topic];
  if (motion.count++ == 0) motion.field = field;
  motion.farthest = std::max(motion.farthest, farthest);
}

void LeftOut::note_opposite_angles(const std::string& topic) { note(opposite_angles_, topic, ""); }

void LeftOut::note_other_order(const std::string& topic) { note(other_order_, topic, ""); }

void LeftOut::note_odd_times(const std::string& topic, const std::string& what) {
  note(odd_times_, topic, what);
}

std::string LeftOut::reason(const std::string& topic) const {
  for (const auto& kind : {&unusable_, &cut_})
    if (const auto found = kind->find(topic); found != kind->end()) return ": " + found->second.first;
  return "";
}

std::string LeftOut::damage() const {
  std::string clause;
  for (const auto& [topic, missing] : cut_)
    clause += (clause.empty() ? "" : "; ") + unusable(missing.count, topic, missing.first);
  return clause;
}

std::vector<std::string> LeftOut::clauses(const std::vector<std::string>& frames, bool by_point_times) const {
  std::vector<std::string> clauses;
  for (const auto& [topic, missing] : unusable_)
    clauses.push_back(unusable(missing.count, topic, missing.first));
  for (const auto& [topic, jumped] : jumped_)
    clauses.push_back("holds " + std::to_string(jumped.count) + " message" + (jumped.count == 1 ? "" : "s") +
                      " in topic " + quote(topic) +
                      " at times at which a pose jumps, which were left out; of the first, " + jumped.first);
  for (const auto& [topic, stamps] : stamps_)
    if (stamps.missing > 0)
      clauses.push_back("holds " + std::to_string(stamps.missing) + " of " + std::to_string(stamps.messages) +
                        " messages of " + quote(topic) +
                        " without a stamp; the times of recording are taken, so that they may be placed by "
                        "poses of a later moment");
  for (const auto& [topic, unseen] : unseen_)
    clauses.push_back("holds " + counted(unseen.count, "cloud") + " in topic " + quote(topic) + " in frame " +
                      quote(unseen.first) +
                      ", which is no sensor's: they mark what is occupied and free nothing, as nothing says "
                      "where the sensor was; `source: {bag: {fixed_frame: …, sensor_frame: …}}` of the setup "
                      "lets their rays begin at a "
                      "frame, `sensors` places them; frames of the bag: " +
                      list_of_frames(frames));
  for (const auto& [topic, standing] : standing_)
    clauses.push_back(
        "holds " + counted(standing.count, "cloud") + " in topic " + quote(topic) + " in frame " +
        quote(standing.first) +
        ", and nothing that says where a sensor was: it is taken to stand at that frame's origin; "
        "`sensors` of the setup places it elsewhere");
  for (const auto& [topic, mounted] : mounted_)
    clauses.push_back("holds " + std::to_string(mounted.count) + " clouds in topic " + quote(topic) +
                      " in frame " + mounted.first);
  for (const auto& [topic, motion] : moved_)
    clauses.push_back(
        "holds " + counted(motion.count, "cloud") + " in topic " + quote(topic) +
        " during which the sensor moved, what it saw by up to " + short_text(motion.farthest) + " m; " +
        (by_point_times ? "each point is placed at its own time, by the field " + quote(motion.field) +
                              "; `point_times: false` in `source: {bag: …}` of the setup takes a cloud as "
                              "seen at its stamp, as where another program did so before"
                        : "each is placed by one pose, at its stamp"));
  for (const auto& [topic, opposite] : opposite_angles_)
    clauses.push_back(
        "holds " + counted(opposite.count, "scan") + " in topic " + quote(topic) +
        " whose angle_increment leads away from their angle_max: one of them is wrong, and the scans "
        "may be mirrored; beams are placed by the increment");
  for (const auto& [topic, other] : other_order_)
    clauses.push_back(
        "holds " + counted(other.count, "cloud") + " in topic " + quote(topic) +
        " that state an order of bytes (`is_bigendian`) in which their points make no sense; the "
        "other one was read");
  for (const auto& [topic, odd] : odd_times_)
    clauses.push_back("holds " + counted(odd.count, "cloud") + " in topic " + quote(topic) +
                      " whose points' times make no sense in s, ms, us or ns since the stamp or 1970 (of the "
                      "first, " +
                      odd.first + "); each is placed by one pose, at its stamp");
  return clauses;
}

}  // namespace clearway
