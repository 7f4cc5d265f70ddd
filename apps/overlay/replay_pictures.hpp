#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "apps/fusion/fusion.hpp"
#include "apps/pages/report.hpp"

namespace clearway {

/// What a replay draws into the pictures of its camera.
struct PictureOptions {
  std::filesystem::path stills;  ///< folder, created; empty: none
  std::filesystem::path video;   ///< .mp4 file; empty: none

  bool are_asked() const { return !stills.empty() || !video.empty(); }
};

/// Refuses, before the work, what cannot be drawn or written. @param out the replay's own folder
/// @throws std::invalid_argument in one sentence: a live camera, which cannot be read twice, or one folder
/// for
///         both; std::runtime_error as AtomicFolder and require_writable
void require_pictures(const PictureOptions& options, const std::filesystem::path& recording,
                      const std::filesystem::path& out);

/// Reads the recording once more and draws what became of it.
/// - Stills QUERY-PLANNER-{start,goal,tightest}.png of each solved plan and QUERY-PLANNER-to_paint.png of the
///   others, in the last image in which the camera's pose is known: plans come after the recording. Without
///   plans painted.png.
/// - The video: each image with the paint so far, the ball and what was refused; then, over that last image,
///   the motion of each query's first solved plan.
/// @throws std::invalid_argument in one sentence: no images, no fixed board, no image with a pose;
///         std::runtime_error: no encoder, or a file that cannot be written
void draw_replay(const std::filesystem::path& recording, const Fusion& fusion, const Snapshot& map,
                 const std::vector<ReplayPlan>& plans, const PictureOptions& options,
                 const std::function<void(double)>& progress);

}  // namespace clearway
