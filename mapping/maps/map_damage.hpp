#pragma once

#include <filesystem>
#include <string>

#include "mapping/snapshot.hpp"

namespace clearway {

/// "the map was made from a damaged recording: 37 records of it were read, what is damaged or came after it
/// is missing"; empty for any other map. Known of maps in our own .ot files and of what is made of them.
std::string damage_caveat(const Snapshot& map);

/// "14 % of what its scans hit others had seen free, as where …", of 300 looks and more (ScanAgreement), by
/// the lower end of Wilson's interval at 95 %; else empty. Of hits in stable places more than a tenth say so:
/// scans of a still scene with the errors of usual sensors and poses come to some 2 %, 2D lasers placed by a
/// robot's odometry to 8 %. Of hits in all places that were observed or are stable more than a fifth do: such
/// scans come to 3 % and 13 %, those with wrong axes or units to 30 % and more, while few of their hits are
/// in stable places.
std::string contradiction_caveat(const Snapshot& map);

/// Of what a verdict must say of this map, what a file that export_map writes does not tell whoever reads it:
/// a cloud nothing; an OctoMap tree not how the map was integrated, nor contradictions.
std::string unsaid_in_export(const Snapshot& map, const std::filesystem::path& file);

/// What a verdict that rests on this map must say of it, a sentence each: how it was integrated
/// (integration_caveat), damage, contradictions, and changes by hand (hand_edit_caveat). Empty when there is
/// nothing to say.
std::string map_caveat(const Snapshot& map);

}  // namespace clearway
