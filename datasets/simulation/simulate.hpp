#pragma once

#include <filesystem>
#include <functional>

#include "datasets/descriptions/scene.hpp"

namespace clearway {

/// What `simulate` wrote.
struct SimulationResult {
  std::filesystem::path recording, truth;
  size_t images = 0, depth_images = 0, included_frames = 0;
  double duration = 0;       ///< s, of the stroke
  double stroke_length = 0;  ///< m, of the ball's way
};

/// Makes a recording of a scene and, beside it, `truth.json` (see datasets/FORMATS.md): the setup's text as a
/// comment, the included frames, the depth images, then one grey image after the other of the probe's stroke.
/// The same scene gives the same bytes, however many threads draw. Both files appear whole or not at all, the
/// recording first; the truth names the recording that it is of by its bytes and their CRC32, so that a kill
/// between the two is told from a pair.
/// `progress` receives the share that is done, 0 to 1.
/// @throws std::invalid_argument when an included recording is unreadable or damaged, std::runtime_error when
/// the files cannot be written.
SimulationResult simulate(const Scene& scene, const std::filesystem::path& recording,
                          const std::function<void(double)>& progress = {});

}  // namespace clearway
