#include "tracking/tag_record.hpp"

#include <algorithm>

namespace clearway {
namespace {

constexpr double kMemory = 0.95;    // of each image before: 20 images, about
constexpr double kFewest = 2.5;     // rejections, with those forgotten
constexpr std::size_t kJudges = 3;  // tags that can show which of them is wrong

}  // namespace

void TagRecord::note(const BodyPose& pose) {
  if (pose.tags.size() + pose.rejected.size() < kJudges) return;
  const auto count = [&](const std::vector<int>& ids, double Votes::*vote) {
    for (int id : ids) {
      Votes& votes = votes_[id];
      votes.kept *= kMemory;
      votes.rejected *= kMemory;
      votes.*vote += 1.0;
    }
  };
  count(pose.tags, &Votes::kept);
  count(pose.rejected, &Votes::rejected);
}

bool TagRecord::is_trusted(int id) const {
  const auto found = votes_.find(id);
  return found == votes_.end() || found->second.rejected < kFewest ||
         found->second.rejected <= found->second.kept;
}

std::vector<TagDetection> TagRecord::trusted(const std::vector<TagDetection>& detections) const {
  std::vector<TagDetection> kept;
  std::copy_if(detections.begin(), detections.end(), std::back_inserter(kept),
               [&](const TagDetection& tag) { return is_trusted(tag.id); });
  return kept;
}

}  // namespace clearway
