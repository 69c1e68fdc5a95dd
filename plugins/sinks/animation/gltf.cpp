// SPDX-License-Identifier: Apache-2.0
#include "gltf.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <sstream>
#include <utility>
#include <weft/core/index.hpp>

// The texture is a PNG already, so that the library needs no codec.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

namespace weft::animation {
namespace {

constexpr std::size_t kPointBytes = 3 * sizeof(float);

std::vector<float> difference(std::vector<float> values, const std::vector<float>& base) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= base[i];
  return values;
}

/// The file's arrays, and what refers to them.
class Arrays {
 public:
  explicit Arrays(tinygltf::Model& model) : model_(model) { model_.buffers.emplace_back(); }

  /// Further bytes as a separate view.
  template <class T>
  int add_view(std::span<const T> values, int target = 0, std::size_t stride = 0) {
    std::vector<unsigned char>& bytes = model_.buffers[0].data;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = values.size_bytes();
    view.byteStride = stride;
    view.target = target;
    const auto* begin = reinterpret_cast<const unsigned char*>(values.data());
    bytes.insert(bytes.end(), begin, begin + values.size_bytes());
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  int add_accessor(int view, int type, int component, std::size_t count, std::size_t offset = 0) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.byteOffset = offset;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int add_floats(const std::vector<float>& values, int type, int target = 0) {
    const auto components = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(type));
    return add_accessor(add_view(std::span<const float>(values), target), type,
                        TINYGLTF_COMPONENT_TYPE_FLOAT, values.size() / components);
  }

  /// Points that follow each other in one view.
  int add_points(int view, std::size_t index, std::size_t vertices) {
    return add_accessor(view, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, vertices,
                        index * vertices * kPointBytes);
  }

  /// The format requires the range of positions and times.
  void set_range(int accessor, std::span<const float> values) {
    tinygltf::Accessor& one = model_.accessors[to_index(accessor)];
    const auto components = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(one.type));
    one.minValues.assign(components, std::numeric_limits<double>::max());
    one.maxValues.assign(components, std::numeric_limits<double>::lowest());
    for (std::size_t i = 0; i < values.size(); ++i) {
      double& low = one.minValues[i % components];
      double& high = one.maxValues[i % components];
      low = std::min(low, static_cast<double>(values[i]));
      high = std::max(high, static_cast<double>(values[i]));
    }
  }

  int add_times(const std::vector<float>& times_s) {
    const int accessor = add_floats(times_s, TINYGLTF_TYPE_SCALAR);
    set_range(accessor, times_s);
    return accessor;
  }

  /// Weights [targets + 2, targets]: none for the base, then each target alone, the last one twice.
  /// Sparse, so that a file does not grow with the square of its frames.
  int add_weights(std::size_t targets) {
    std::vector<std::uint32_t> places;
    for (std::size_t row = 1; row <= targets + 1; ++row) {
      places.push_back(static_cast<std::uint32_t>(row * targets + std::min(row, targets) - 1));
    }
    const std::vector<float> ones(places.size(), 1.0F);
    const int indices = add_view(std::span<const std::uint32_t>(places));
    const int values = add_view(std::span<const float>(ones));
    const int accessor = add_accessor(-1, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                      (targets + 2) * targets);
    auto& sparse = model_.accessors[to_index(accessor)].sparse;
    sparse.isSparse = true;
    sparse.count = static_cast<int>(places.size());
    sparse.indices = {0, indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT};
    sparse.values = {values, 0};
    return accessor;
  }

 private:
  tinygltf::Model& model_;
};

void add_material(const Scene& scene, Arrays& arrays, tinygltf::Model& model) {
  tinygltf::Image image;
  image.mimeType = "image/png";
  image.bufferView = arrays.add_view(std::span<const std::uint8_t>(scene.texture_png));
  model.images.push_back(std::move(image));
  tinygltf::Sampler sampler;
  sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
  sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  model.samplers.push_back(sampler);
  tinygltf::Texture texture;
  texture.sampler = 0;
  texture.source = 0;
  model.textures.push_back(std::move(texture));
  tinygltf::Material material;
  material.name = "texture";
  material.doubleSided = true;
  material.pbrMetallicRoughness.baseColorTexture.index = 0;
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  model.materials.push_back(std::move(material));
}

std::vector<const Frame*> shapes_of(const std::vector<Frame>& frames) {
  std::vector<const Frame*> shapes;
  for (const Frame& frame : frames) {
    if (!frame.vertices_m.empty()) shapes.push_back(&frame);
  }
  return shapes;
}

/// The first shape, and a target for each other.
void add_mesh(const Scene& scene, const std::vector<const Frame*>& shapes, Arrays& arrays,
              tinygltf::Model& model) {
  const std::vector<float>& base = shapes[0]->vertices_m;
  const std::vector<float>& base_normals = shapes[0]->normals;
  const std::size_t vertices = base.size() / 3;
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = 0;
  const std::vector<std::uint32_t> indices(scene.faces.data(),
                                           scene.faces.data() + scene.faces.size());
  primitive.indices = arrays.add_accessor(arrays.add_view(std::span<const std::uint32_t>(indices),
                                                          TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER),
                                          TINYGLTF_TYPE_SCALAR,
                                          TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, indices.size());
  constexpr int kVertices = TINYGLTF_TARGET_ARRAY_BUFFER;
  const int position = arrays.add_floats(base, TINYGLTF_TYPE_VEC3, kVertices);
  arrays.set_range(position, base);
  primitive.attributes["POSITION"] = position;
  primitive.attributes["NORMAL"] = arrays.add_floats(base_normals, TINYGLTF_TYPE_VEC3, kVertices);
  primitive.attributes["TEXCOORD_0"] =
      arrays.add_floats(scene.texture_uv, TINYGLTF_TYPE_VEC2, kVertices);
  std::vector<float> points;
  points.reserve(6 * vertices * shapes.size());
  tinygltf::Value::Array names;
  for (std::size_t i = 1; i < shapes.size(); ++i) {
    for (const auto& part :
         {difference(shapes[i]->vertices_m, base), difference(shapes[i]->normals, base_normals)}) {
      points.insert(points.end(), part.begin(), part.end());
    }
    names.emplace_back(shapes[i]->name);
  }
  tinygltf::Mesh mesh;
  mesh.name = "surface";
  if (!names.empty()) {
    const int view = arrays.add_view(std::span<const float>(points), kVertices, kPointBytes);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const int moved = arrays.add_points(view, 2 * i, vertices);
      arrays.set_range(moved, std::span(points).subspan(6 * i * vertices, 3 * vertices));
      primitive.targets.push_back(
          {{"POSITION", moved}, {"NORMAL", arrays.add_points(view, 2 * i + 1, vertices)}});
    }
    mesh.weights.assign(names.size(), 0.0);
    mesh.extras = tinygltf::Value({{"targetNames", tinygltf::Value(names)}});
  }
  mesh.primitives.push_back(std::move(primitive));
  model.meshes.push_back(std::move(mesh));
}

void add_camera(const Camera& camera, tinygltf::Model& model) {
  tinygltf::Camera perspective;
  perspective.type = "perspective";
  perspective.name = "camera";
  perspective.perspective.yfov =
      2.0 * std::atan(0.5 * static_cast<double>(camera.height_px) / camera.fy);
  perspective.perspective.aspectRatio = static_cast<double>(camera.width_px) * camera.fy /
                                        (static_cast<double>(camera.height_px) * camera.fx);
  perspective.perspective.znear = 0.01;
  perspective.perspective.zfar = 100.0;
  model.cameras.push_back(std::move(perspective));
}

/// A channel of the animation that keeps each value until the next.
void add_channel(tinygltf::Animation& animation, const char* path, int times, int values) {
  tinygltf::AnimationSampler sampler;
  sampler.input = times;
  sampler.output = values;
  sampler.interpolation = "STEP";
  animation.samplers.push_back(std::move(sampler));
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size()) - 1;
  channel.target_node = 0;
  channel.target_path = path;
  animation.channels.push_back(std::move(channel));
}

void add_animation(const Scene& scene, const std::vector<Frame>& frames, Arrays& arrays,
                   tinygltf::Model& model) {
  const auto time_s = [&](std::uint64_t number) {
    return static_cast<float>(static_cast<double>(number - frames[0].number) / scene.fps);
  };
  tinygltf::Animation animation;
  animation.name = "run";
  std::vector<float> shape_times, change_times, scales;
  bool hidden = false;
  for (const Frame& frame : frames) {
    const bool has_shape = !frame.vertices_m.empty();
    if (has_shape) shape_times.push_back(time_s(frame.number));
    if (hidden != has_shape && !change_times.empty()) continue;
    hidden = !has_shape;
    change_times.push_back(time_s(frame.number));
    scales.insert(scales.end(), 3, has_shape ? 1.0F : 0.0F);
  }
  const std::size_t shapes = shape_times.size();
  if (shapes > 1) {
    // The last shape lasts as long as the others.
    shape_times.push_back(time_s(frames.back().number + 1));
    add_channel(animation, "weights", arrays.add_times(shape_times),
                arrays.add_weights(shapes - 1));
  }
  if (shapes < frames.size()) {
    add_channel(animation, "scale", arrays.add_times(change_times),
                arrays.add_floats(scales, TINYGLTF_TYPE_VEC3));
  }
  if (!animation.channels.empty()) model.animations.push_back(std::move(animation));
}

}  // namespace

std::vector<float> normals_of(const std::vector<float>& vertices_m, const Faces& faces) {
  using Points = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>;
  const Points points(vertices_m.data(), static_cast<Eigen::Index>(vertices_m.size() / 3), 3);
  Points3 sums = Points3::Zero(points.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const auto corner = [&](int k) {
      return points.row(faces(f, k)).cast<double>().transpose().eval();
    };
    const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (int k = 0; k < 3; ++k) sums.row(faces(f, k)) += normal.transpose();
  }
  std::vector<float> normals;
  normals.reserve(vertices_m.size());
  for (Eigen::Index v = 0; v < sums.rows(); ++v) {
    const double length = sums.row(v).norm();
    const Eigen::Vector3d normal =
        length > 0.0 ? (sums.row(v).transpose() / length).eval() : Eigen::Vector3d(0, 0, -1);
    for (int k = 0; k < 3; ++k) normals.push_back(static_cast<float>(normal[k]));
  }
  return normals;
}

std::string to_glb(const Scene& scene, const std::vector<Frame>& frames) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "Weft sinks/animation";
  Arrays arrays(model);
  add_material(scene, arrays, model);
  add_mesh(scene, shapes_of(frames), arrays, model);
  add_camera(scene.camera, model);
  tinygltf::Node surface, camera;
  surface.name = "surface";
  surface.mesh = 0;
  surface.rotation = {1.0, 0.0, 0.0, 0.0};
  camera.name = "camera";
  camera.camera = 0;
  model.nodes = {surface, camera};
  model.scenes.emplace_back();
  model.scenes[0].nodes = {0, 1};
  model.defaultScene = 0;
  add_animation(scene, frames, arrays, model);
  std::ostringstream stream;
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true);
  return std::move(stream).str();
}

}  // namespace weft::animation
