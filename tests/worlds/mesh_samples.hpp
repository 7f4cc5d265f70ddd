#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <locale>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace clearway {

/// A triangle mesh with known vertices, and the text of a file that holds it, for every kind that we read.
struct MeshSample {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<int, 3>> triangles;
};

/// An ellipsoid of these half axes, all of whose vertices are corners of its hull.
inline MeshSample ellipsoid(int rings, int sectors, const Eigen::Vector3f& half_axes) {
  MeshSample mesh;
  mesh.vertices.push_back({0.0F, 0.0F, half_axes.z()});
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < sectors; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2.0 * std::numbers::pi * j / sectors;
      const Eigen::Vector3d at(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      mesh.vertices.push_back(at.cast<float>().cwiseProduct(half_axes));
    }
  }
  mesh.vertices.push_back({0.0F, 0.0F, -half_axes.z()});
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  const auto at = [&](int ring, int sector) { return 1 + (ring - 1) * sectors + sector % sectors; };
  for (int j = 0; j < sectors; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

class MeshText {
 public:
  MeshText() {
    text_.imbue(std::locale::classic());
    text_.precision(9);
  }
  template <typename... Words>
  MeshText& line(const Words&... words) {
    ((text_ << words << ' '), ...);
    text_ << '\n';
    return *this;
  }
  template <typename Number>
  MeshText& raw(const Number& number) {
    text_.write(reinterpret_cast<const char*>(&number), sizeof(number));
    return *this;
  }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

inline std::string as_obj(const MeshSample& mesh) {
  MeshText out;
  for (const auto& v : mesh.vertices) out.line('v', v.x(), v.y(), v.z());
  for (const auto& t : mesh.triangles) out.line('f', t[0] + 1, t[1] + 1, t[2] + 1);
  return out.text();
}

inline std::string as_text_stl(const MeshSample& mesh) {
  MeshText out;
  out.line("solid s");
  for (const auto& t : mesh.triangles) {
    out.line("facet normal 0 0 0").line("outer loop");
    for (int i : t) {
      const Eigen::Vector3f& v = mesh.vertices[static_cast<std::size_t>(i)];
      out.line("vertex", v.x(), v.y(), v.z());
    }
    out.line("endloop").line("endfacet");
  }
  return out.line("endsolid s").text();
}

inline std::string as_stl(const MeshSample& mesh) {
  MeshText out;
  out.raw(std::array<char, 80>{}).raw(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    out.raw(std::array<float, 3>{});
    for (int i : t) {
      const Eigen::Vector3f& v = mesh.vertices[static_cast<std::size_t>(i)];
      out.raw(v.x()).raw(v.y()).raw(v.z());
    }
    out.raw(std::uint16_t{0});
  }
  return out.text();
}

inline std::string as_ply(const MeshSample& mesh, bool binary) {
  MeshText out;
  out.line("ply").line(binary ? "format binary_little_endian 1.0" : "format ascii 1.0");
  out.line("element vertex", mesh.vertices.size());
  for (char axis : {'x', 'y', 'z'}) out.line("property float", axis);
  out.line("element face", mesh.triangles.size()).line("property list uchar int vertex_indices");
  std::string head = out.text();
  for (std::size_t at; (at = head.find(" \n")) != std::string::npos;) head.erase(at, 1);
  MeshText data;
  for (const auto& v : mesh.vertices) {
    if (binary)
      data.raw(v.x()).raw(v.y()).raw(v.z());
    else
      data.line(v.x(), v.y(), v.z());
  }
  for (const auto& t : mesh.triangles) {
    if (binary)
      data.raw(std::uint8_t{3}).raw(t);
    else
      data.line(3, t[0], t[1], t[2]);
  }
  return head + "end_header\n" + data.text();
}

inline std::string as_dae(const MeshSample& mesh) {
  MeshText out;
  out.line(
         "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'>")
      .line("<asset><unit name='meter' meter='1'/><up_axis>Z_UP</up_axis></asset>")
      .line("<library_geometries><geometry id='g'><mesh><source id='p'><float_array id='a' count='" +
            std::to_string(3 * mesh.vertices.size()) + "'>");
  for (const auto& v : mesh.vertices) out.line(v.x(), v.y(), v.z());
  out.line("</float_array><technique_common><accessor source='#a' stride='3' count='" +
           std::to_string(mesh.vertices.size()) + "'>")
      .line("<param name='X' type='float'/><param name='Y' type='float'/><param name='Z' type='float'/>")
      .line(
          "</accessor></technique_common></source><vertices id='v'><input semantic='POSITION' source='#p'/>")
      .line("</vertices><triangles count='" + std::to_string(mesh.triangles.size()) +
            "'><input semantic='VERTEX' source='#v' offset='0'/><p>");
  for (const auto& t : mesh.triangles) out.line(t[0], t[1], t[2]);
  out.line("</p></triangles></mesh></geometry></library_geometries>")
      .line("<library_visual_scenes><visual_scene id='s'><node id='n'>")
      .line("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url='#g'/></node>")
      .line(
          "</visual_scene></library_visual_scenes><scene><instance_visual_scene "
          "url='#s'/></scene></COLLADA>");
  return out.text();
}

/// The mesh in every kind of file: name and content.
inline std::map<std::string, std::string> all_mesh_files(const MeshSample& mesh) {
  return {{"mesh.obj", as_obj(mesh)},        {"text.stl", as_text_stl(mesh)},  {"mesh.stl", as_stl(mesh)},
          {"text.ply", as_ply(mesh, false)}, {"mesh.ply", as_ply(mesh, true)}, {"mesh.dae", as_dae(mesh)}};
}

}  // namespace clearway
