#pragma once

#include <string>

#include "mapping/snapshot.hpp"

namespace clearway {

/// "the map was made from a damaged recording: 37 records of it were read, what is damaged or came after it
/// is missing"; empty for any other map. Known of maps in our own .ot files and of what is made of them.
std::string damage_caveat(const Snapshot& map);

/// "14 % of what its scans hit others had seen free, as where poses, times or calibration are wrong, or rays
/// meet surfaces at a slant and far apart", of a map whose share (ScanAgreement) is more than a tenth of a
/// thousand looks and more; else empty. Scans of a still scene with the errors of usual sensors and poses
/// come to some 2 %.
std::string contradiction_caveat(const Snapshot& map);

/// What a verdict that rests on this map must say of it, a sentence each: how it was integrated
/// (integration_caveat), damage, contradictions, and changes by hand (hand_edit_caveat). Empty when there is
/// nothing to say.
std::string map_caveat(const Snapshot& map);

}  // namespace clearway
