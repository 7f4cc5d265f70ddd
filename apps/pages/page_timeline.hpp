#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/fusion/recording_timeline.hpp"
#include "apps/pages/page_arrays.hpp"
#include "mapping/history/provenance.hpp"

namespace clearway {

/// The most spheres of a timeline; of more an even choice is shown.
inline constexpr std::size_t most_timeline_balls = 20'000;

/// For the page: images, scans, refusals, spheres and conflicts by the time at which they came; see Timeline
/// in apps/viewer/src/data.ts. Null when nothing of the recording has a time.
nlohmann::json timeline_json(PageArrays& arrays, const RecordingTimeline& recording,
                             const Provenance& provenance);

}  // namespace clearway
