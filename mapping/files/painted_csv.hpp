#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/voxels/painted_volume.hpp"

namespace clearway {

/// The painted volumes as comma-separated text: one line a sphere, in painting order, volumes by index;
/// metres and seconds with every digit that a double has, so that reading gives the same bits. Columns:
///   volume,label,critical_parts,x,y,z,radius,time,stroke,stroke_label,source
/// Spheres are those that are left after erasing. Strokes are numbered within their volume by their first
/// sphere; a sphere of no stroke leaves the last three columns empty. Critical parts are separated by ';'
/// ('\' escapes ';' and '\'). A volume without spheres has one line with empty numbers.
/// @throws std::invalid_argument for a label, part or source with control characters.
std::string format_painted(const std::vector<PaintedVolume>& volumes);

/// Reads what format_painted wrote, or a text without the last three columns, as earlier versions wrote it;
/// the time span of a stroke is that of its spheres. `file` is named in errors.
/// @throws DamagedFile naming the line and what was expected there.
std::vector<PaintedVolume> parse_painted(std::string_view text, const std::filesystem::path& file);

/// Of spheres that a file names for a map of this resolution (metres): each voxel takes memory.
/// @throws std::invalid_argument naming the file and the first sphere of more than 1,000 voxels' radius
void require_paintable(const std::vector<PaintedVolume>& volumes, double resolution,
                       const std::filesystem::path& file);

}  // namespace clearway
