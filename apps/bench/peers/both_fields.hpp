#pragma once

// Our distance field and dynamicEDT3D's, of the same voxels of one map.

#include <dynamicEDT3D/dynamicEDTOctomap.h>
#include <octomap/OcTree.h>

#include <memory>

#include "mapping/field/blocked_field.hpp"
#include "mapping/snapshot.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {

/// The voxels that `requirement` forbids and the free ones, as a stock tree.
inline std::unique_ptr<octomap::OcTree> stock_tree(const FusedTree& tree, const Requirement& requirement) {
  auto stock = std::make_unique<MirrorTree<octomap::OcTree>>(tree.getResolution());
  stock->mirror(tree, [&](const FusedNode& from, octomap::OcTreeNode& to) {
    const bool allowed = allows(requirement, tree.state(from), from.painted());
    to.setLogOdds(allowed ? stock->getClampingThresMinLog() : stock->getClampingThresMaxLog());
  });
  return stock;
}

/// One requirement, one region and one truncation: both fields from nothing, ours as a whole.
struct BothFields {
  BothFields(const Snapshot& map, Policy policy, const Eigen::AlignedBox3d& box, double max_distance)
      : tree(map.tree()),
        requirement{policy},
        region(field_region(box, map.resolution(), max_distance)),
        stock(stock_tree(tree, requirement)) {}

  std::unique_ptr<BlockedField> ours() const {
    auto field = std::make_unique<BlockedField>(tree, requirement, region);
    field->distances()->complete();
    return field;
  }
  std::unique_ptr<DynamicEDTOctomap> theirs() const {
    const Eigen::Vector3f low =
        ((region.first.cast<double>().array() + 0.5) * region.resolution).cast<float>();
    const Eigen::Vector3f high = ((region.first + region.size).cast<double>().array() - 0.5).cast<float>() *
                                 static_cast<float>(region.resolution);
    auto field = std::make_unique<DynamicEDTOctomap>(
        static_cast<float>(region.max_distance), stock.get(), octomap::point3d(low.x(), low.y(), low.z()),
        octomap::point3d(high.x(), high.y(), high.z()), requirement.policy != Policy::not_occupied);
    field->update();
    return field;
  }

  const FusedTree& tree;
  Requirement requirement;
  FieldRegion region;
  std::unique_ptr<octomap::OcTree> stock;
};

}  // namespace clearway::bench
