#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_check.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/byte_reader.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

constexpr const char* file_name = "provenance.bin";
constexpr std::string_view first_line = "# Clearway provenance 1\n";
constexpr std::string_view end_of_header = "data\n";
constexpr std::size_t largest_file = std::size_t{2} << 30U;
constexpr std::size_t most_scans = std::size_t{1} << 31U;

// ---- writing: little-endian numbers, texts and byte strings with their length before them

void put_text(std::string& bytes, const std::string& text) {
  put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

void put_cell(std::string& bytes, const Eigen::Vector3i& cell) {
  for (int axis = 0; axis < 3; ++axis) put(bytes, static_cast<std::int32_t>(cell[axis]));
}

void put_cells(std::string& bytes, const TouchedCells& cells) {
  put(bytes, cells.raw_bytes());
  put_text(bytes, cells.packed());
}

void put_event(std::string& bytes, const PaintEvent& event) {
  put(bytes, static_cast<std::int32_t>(event.volume));
  put(bytes, static_cast<std::int32_t>(event.stroke));
  put(bytes, static_cast<std::uint8_t>(event.erases));
  for (int axis = 0; axis < 3; ++axis) put(bytes, event.sphere.center[axis]);
  put(bytes, event.sphere.radius);
  put(bytes, event.time);
}

void put_conflict(std::string& bytes, const ConflictRecord& record) {
  put_cell(bytes, record.cell);
  put(bytes, record.time);
  put(bytes, static_cast<std::uint8_t>(record.by_scan));
  put(bytes, static_cast<std::int32_t>(record.index));
  put(bytes, static_cast<std::int32_t>(record.volume));
}

void put_scan(std::string& bytes, const ScanRecord& scan) {
  put(bytes, static_cast<std::int32_t>(scan.number));
  put_text(bytes, scan.sensor);
  put(bytes, scan.time);
  put_cell(bytes, scan.low);
  put_cell(bytes, scan.high);
  put(bytes, static_cast<std::uint8_t>(scan.hits_kept ? 1 : 0));
  put(bytes, static_cast<std::uint8_t>(scan.misses_kept ? 1 : 0));
  put_cells(bytes, scan.hits);
  put_cells(bytes, scan.misses);
}

// ---- reading: every length is held against what is left

class ProvenanceReader : public ByteReader {
 public:
  using ByteReader::ByteReader;

  std::string text() {
    const auto size = get<std::uint32_t>();
    return std::string(take(size));
  }

  bool flag() {
    const auto value = get<std::uint8_t>();
    if (value > 1) refuse("a flag is neither 0 nor 1");
    return value == 1;
  }

  /// An index below `end`; -1 where that is allowed.
  int index(std::size_t end, bool may_be_none) {
    const auto value = get<std::int32_t>();
    if (value == -1 && may_be_none) return value;
    if (value < 0 || static_cast<std::size_t>(value) >= end) refuse("an index leads nowhere");
    return value;
  }

  Eigen::Vector3i cell() {
    Eigen::Vector3i result;
    for (int axis = 0; axis < 3; ++axis) {
      result[axis] = get<std::int32_t>();
      if (result[axis] < -32768 || result[axis] > 32767) refuse("a cell lies outside of every map");
    }
    return result;
  }

  TouchedCells cells() {
    const auto raw_bytes = get<std::uint32_t>();
    std::string packed = text();
    if (raw_bytes / 1100 > packed.size())
      refuse("the cells of a scan do not unpack");  // deflate: 1032 at most
    TouchedCells result(std::move(packed), raw_bytes);
    if (!result.is_sound()) refuse("the cells of a scan do not unpack");
    return result;
  }
};

PaintEvent read_event(ProvenanceReader& reader, std::size_t volumes, std::size_t strokes) {
  PaintEvent event;
  event.volume = reader.index(volumes, false);
  event.stroke = reader.index(strokes, true);
  event.erases = reader.flag();
  for (int axis = 0; axis < 3; ++axis) event.sphere.center[axis] = reader.get<double>();
  event.sphere.radius = reader.get<double>();
  event.time = reader.get<double>();
  if (!(event.sphere.radius > 0.0)) reader.refuse("a ball has no radius");
  return event;
}

ConflictRecord read_conflict(ProvenanceReader& reader, std::size_t volumes, std::size_t strokes) {
  ConflictRecord record;
  record.cell = reader.cell();
  record.time = reader.get<double>();
  record.by_scan = reader.flag();
  record.index = reader.index(record.by_scan ? most_scans : strokes, !record.by_scan);
  record.volume = reader.index(volumes, record.by_scan);
  return record;
}

ScanRecord read_scan(ProvenanceReader& reader) {
  ScanRecord scan;
  scan.number = reader.index(most_scans, false);
  scan.sensor = reader.text();
  scan.time = reader.get<double>();
  scan.low = reader.cell();
  scan.high = reader.cell();
  scan.hits_kept = reader.flag();
  scan.misses_kept = reader.flag();
  scan.hits = reader.cells();
  scan.misses = reader.cells();
  return scan;
}

}  // namespace

std::string format_provenance(const Provenance& provenance) {
  std::string bytes(end_of_header);
  put_text(bytes, provenance.map_sha256);
  put(bytes, provenance.resolution);
  put(bytes, std::uint64_t{provenance.volumes.size()});
  for (const std::string& label : provenance.volumes) put_text(bytes, label);
  put(bytes, std::uint64_t{provenance.strokes.size()});
  for (const Stroke& stroke : provenance.strokes) {
    put_text(bytes, stroke.label);
    put_text(bytes, stroke.source);
  }
  put(bytes, std::uint64_t{provenance.events.size()});
  for (const PaintEvent& event : provenance.events) put_event(bytes, event);
  put(bytes, std::uint64_t{provenance.conflicts.not_kept});
  put(bytes, std::uint64_t{provenance.conflicts.records.size()});
  for (const ConflictRecord& record : provenance.conflicts.records) put_conflict(bytes, record);
  put(bytes, std::uint64_t{provenance.scans.not_recorded()});
  put(bytes, std::uint64_t{provenance.scans.scans().size()});
  for (const ScanRecord& scan : provenance.scans.scans()) put_scan(bytes, scan);
  const std::string head(first_line);
  return head + seal_line(head, bytes) + bytes;
}

Provenance parse_provenance(std::string_view bytes, const std::filesystem::path& file) {
  const auto header = bytes.find(end_of_header);
  if (!bytes.starts_with(first_line) || header == std::string_view::npos || !is_sealed(bytes)) {
    throw DamagedFile("'" + file.string() + "' is damaged: its checksum does not fit");
  }
  ProvenanceReader reader(bytes.substr(header + end_of_header.size()), file);
  Provenance provenance;
  provenance.map_sha256 = reader.text();
  provenance.resolution = reader.get<double>();
  if (!(provenance.resolution > 0.0)) reader.refuse("its resolution is not a length");
  for (std::size_t i = reader.count(4); i > 0; --i) provenance.volumes.push_back(reader.text());
  for (std::size_t i = reader.count(8); i > 0; --i) {
    std::string label = reader.text();
    provenance.strokes.push_back({std::move(label), reader.text()});
  }
  const std::size_t volumes = provenance.volumes.size(), strokes = provenance.strokes.size();
  for (std::size_t i = reader.count(49); i > 0; --i)
    provenance.events.push_back(read_event(reader, volumes, strokes));
  provenance.conflicts.not_kept = reader.get<std::uint64_t>();
  for (std::size_t i = reader.count(29); i > 0; --i)
    provenance.conflicts.records.push_back(read_conflict(reader, volumes, strokes));
  const auto not_recorded = static_cast<std::size_t>(reader.get<std::uint64_t>());
  std::vector<ScanRecord> scans;
  for (std::size_t i = reader.count(58); i > 0; --i) scans.push_back(read_scan(reader));
  if (!reader.at_end()) reader.refuse("something follows after its end");
  provenance.scans = ScanLog(std::move(scans), not_recorded);
  return provenance;
}

void save_provenance(Provenance provenance, const std::filesystem::path& directory) {
  provenance.map_sha256 = map_sha256(directory);
  save_file(directory / file_name, format_provenance(provenance));
}

std::optional<Provenance> load_provenance(const std::filesystem::path& map) {
  std::error_code error;
  const std::filesystem::path file = map / file_name;
  if (!std::filesystem::is_directory(map, error) || !std::filesystem::exists(file, error))
    return std::nullopt;
  return parse_provenance(read_input(file, "provenance", largest_file), file);
}

}  // namespace clearway
