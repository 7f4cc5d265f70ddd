#pragma once

#include <filesystem>
#include <memory>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Whether a file is a scan graph of OctoMap: by its name, NAME.graph or NAME.graph.gz, or as a text, plain
/// or gz, whose first line begins with NODE. Lines that are empty or begin with # or a blank do not count.
bool is_scan_graph(const std::filesystem::path& file);

/// A scan graph of OctoMap, plain or gz, its nodes in their order as scans of kind "points", called like the
/// file: what octomap::ScanGraph::readBinary reads, whose edges are passed over, or readPlainASCII, lines
/// "NODE x y z roll pitch yaw" (m, rad), each followed by the points of its scan, "x y z". Points are in the
/// frame of their node, or, with `clouds: map`, in the map's, as for graph2tree with -g; rays begin at the
/// node. A graph holds no times: scans are one second apart.
/// @throws std::invalid_argument when the file cannot be read, or is packed in another way than gz
std::unique_ptr<FrameSource> open_scan_graph(const std::filesystem::path& file, const SourceOptions& options);

}  // namespace clearway
