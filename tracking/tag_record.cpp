#include "tracking/tag_record.hpp"

#include <algorithm>

namespace clearway {
namespace {

constexpr double kMemory = 0.95;    // of each image before: 20 images, about
constexpr double kFewest = 2.5;     // rejections, with those forgotten
constexpr std::size_t kJudges = 3;  // tags that can show which of them is wrong

bool outweighs(double against, double in_favour) { return against >= kFewest && against > in_favour; }

}  // namespace

void TagRecord::note(const BodyPose& pose, bool is_explained) {
  const auto count = [&](const std::vector<int>& ids, double Votes::*yes, double Votes::*no) {
    for (int id : ids) {
      Votes& votes = votes_[id];
      votes.*yes = kMemory * votes.*yes + 1.0;
      votes.*no *= kMemory;
    }
  };
  if (pose.tags.size() + pose.rejected.size() >= kJudges) {
    count(pose.tags, &Votes::kept, &Votes::rejected);
    count(pose.rejected, &Votes::rejected, &Votes::kept);
  }
  if (pose.tags.size() < 2) return;
  if (is_explained)
    count(pose.tags, &Votes::agreed, &Votes::disputed);
  else if (pose.tags.size() < kJudges)
    count(pose.tags, &Votes::disputed, &Votes::agreed);
}

bool TagRecord::is_trusted(int id) const {
  const auto found = votes_.find(id);
  return found == votes_.end() || !outweighs(found->second.rejected, found->second.kept);
}

bool TagRecord::is_disputed(int id) const {
  const auto found = votes_.find(id);
  return found != votes_.end() && outweighs(found->second.disputed, found->second.agreed);
}

std::vector<TagDetection> TagRecord::trusted(const std::vector<TagDetection>& detections) const {
  std::vector<TagDetection> kept;
  std::copy_if(detections.begin(), detections.end(), std::back_inserter(kept),
               [&](const TagDetection& tag) { return is_trusted(tag.id); });
  return kept;
}

}  // namespace clearway
