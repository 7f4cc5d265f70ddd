#include "tests/evidence/pose_evidence.hpp"

#include <algorithm>

#include "mapping/free_space_map.hpp"
#include "mapping/snapshot.hpp"
#include "tests/worlds/tracked_session.hpp"
#include "tracking/probe.hpp"

namespace clearway::evidence {
namespace {

/// Whether the cube of a voxel lies in the ball at one of the places where it truly was.
bool was_free(const Eigen::Vector3d& center, double edge, const scene::TrackedSession& session) {
  const double radius = session.probe.ball_radius;
  return std::any_of(session.true_way.begin(), session.true_way.end(), [&](const Eigen::Vector3d& ball) {
    const Eigen::Vector3d farthest = (center - ball).cwiseAbs() + Eigen::Vector3d::Constant(0.5 * edge);
    return farthest.norm() <= radius;
  });
}

void count_voxels(const FreeSpaceMap& map, const scene::TrackedSession& session, PoseEvidence& evidence) {
  const Snapshot snapshot = map.snapshot();
  const double edge = snapshot.resolution();
  snapshot.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != VoxelState::painted) return;
    const int count = static_cast<int>(std::lround(leaf.size / edge));
    const Eigen::Vector3d low = leaf.center - Eigen::Vector3d::Constant(0.5 * (leaf.size - edge));
    for (int i = 0; i < count * count * count; ++i) {
      const Eigen::Vector3d cell(i % count, i / count % count, i / (count * count));
      ++evidence.painted_voxels;
      if (!was_free(low + edge * cell, edge, session)) ++evidence.voxels_beyond;
    }
  });
}

}  // namespace

void PoseEvidence::add(const PoseEvidence& other) {
  sessions += other.sessions;
  samples += other.samples;
  accepted += other.accepted;
  outside += other.outside;
  painted_voxels += other.painted_voxels;
  voxels_beyond += other.voxels_beyond;
  for (const auto& [name, count] : other.refused) refused[name] += count;
  for (const auto& [name, count] : other.accepted_by_tags) accepted_by_tags[name] += count;
  for (const auto& [name, count] : other.outside_by_tags) outside_by_tags[name] += count;
  ratio.insert(ratio.end(), other.ratio.begin(), other.ratio.end());
  share.insert(share.end(), other.share.begin(), other.share.end());
  broken.insert(broken.end(), other.broken.begin(), other.broken.end());
}

PoseEvidence track_session(std::uint64_t seed, int frames, double severity) {
  const scene::TrackedSession session = scene::draw_session(seed, frames, severity);
  AcceptanceOptions acceptance;
  acceptance.fixed_camera = seed % 2 == 0;
  Probe probe(session.camera, session.base, session.probe, session.budget, acceptance);
  MapOptions options;
  options.resolution = session.probe.ball_radius / 6.0;
  FreeSpaceMap map(options);
  const int volume = map.add_volume("tool", {});
  PoseEvidence evidence;
  evidence.sessions = 1;
  for (const scene::TrackedFrame& frame : session.frames) {
    const PaintingSample sample = probe.sample(frame.detections, frame.time);
    ++evidence.samples;
    if (!sample.accepted) {
      ++evidence.refused[to_string(sample.refusal)];
      continue;
    }
    ++evidence.accepted;
    const double error = (sample.sphere.center - frame.true_ball).norm();
    const std::string tags =
        std::to_string(sample.base->tags.size()) + "x" + std::to_string(sample.probe->tags.size());
    ++evidence.accepted_by_tags[tags];
    if (!(error <= sample.bound.total)) {
      ++evidence.outside;
      ++evidence.outside_by_tags[tags];
    }
    evidence.ratio.push_back(error / sample.bound.total);
    evidence.share.push_back(sample.sphere.radius / session.probe.ball_radius);
    map.paint(volume, {sample.sphere.center, sample.sphere.radius}, frame.time);
  }
  count_voxels(map, session, evidence);
  if (evidence.outside > 0 || evidence.voxels_beyond > 0)
    evidence.broken.push_back(session.what + ": " + std::to_string(evidence.outside) + " of " +
                              std::to_string(evidence.accepted) + " samples outside their bound, " +
                              std::to_string(evidence.voxels_beyond) + " voxels beyond free space");
  return evidence;
}

}  // namespace clearway::evidence
