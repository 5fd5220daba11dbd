#pragma once
// Conversions between the library's memory and NumPy's. Arrays are copied: neither side depends on the other's
// lifetime.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/image/image.h"

namespace oraclegs::python {

namespace py = pybind11;

template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

template <class T>
py::array_t<T> ToArray(const std::vector<py::ssize_t>& shape, const T* data) {
  return py::array_t<T>(shape, data);
}
template <class T>
py::array_t<T> ToArray(const Buffer<T>& buffer) {
  std::vector<py::ssize_t> shape;
  for (int d = 0; d < buffer.dims(); ++d) shape.push_back(buffer.size(d));
  return ToArray(shape, buffer.data());
}
inline py::array_t<float> ToArray(const ImageF& image) {
  return ToArray({image.height, image.width, image.channels}, image.data.data());
}

/// A copy of an array of this shape, -1 for any size. Raises ValueError naming it.
inline Buffer<float> ToBuffer(const char* name, const Array<float>& array, const std::vector<int64_t>& shape) {
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  for (size_t d = 0; fits && d < shape.size(); ++d) {
    fits = shape[d] < 0 || array.shape(static_cast<py::ssize_t>(d)) == shape[d];
  }
  const auto has = [&](size_t d) { return d < static_cast<size_t>(array.ndim()) ? array.shape(d) : 0; };
  if (!fits) {
    std::string wanted, got;
    for (const int64_t size : shape) wanted += (wanted.empty() ? "" : ", ") + (size < 0 ? "N" : std::to_string(size));
    for (size_t d = 0; d < static_cast<size_t>(array.ndim()); ++d) got += (d ? ", " : "") + std::to_string(has(d));
    throw py::value_error(std::string(name) + " has shape (" + got + "), expected (" + wanted + ")");
  }
  const std::span<const float> values(array.data(), static_cast<size_t>(array.size()));
  switch (shape.size()) {
    case 1:
      return Buffer<float>::From({has(0)}, values);
    case 2:
      return Buffer<float>::From({has(0), has(1)}, values);
    default:
      return Buffer<float>::From({has(0), has(1), has(2)}, values);
  }
}

/// (K [3,3], world_to_camera [4,4], width, height), which camera.py makes a Camera of.
inline py::tuple CameraTuple(const Camera& camera) {
  const double k[9] = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> pose = camera.cam_from_world.matrix();
  return py::make_tuple(ToArray({3, 3}, k), ToArray({4, 4}, pose.data()), camera.width, camera.height);
}

/// Camera from such arrays. Raises InputError unless it is a pinhole camera.
inline Camera CameraFrom(const Array<double>& k, const Array<double>& pose, int width, int height) {
  if (k.ndim() != 2 || k.shape(0) != 3 || k.shape(1) != 3) throw py::value_error("K must have shape (3, 3)");
  if (pose.ndim() != 2 || pose.shape(1) != 4 || (pose.shape(0) != 3 && pose.shape(0) != 4)) {
    throw py::value_error("world_to_camera must have shape (4, 4) or (3, 4)");
  }
  if (k.at(0, 1) != 0) throw py::value_error("K has skew, which is not rendered");
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = k.at(0, 0), camera.fy = k.at(1, 1), camera.cx = k.at(0, 2), camera.cy = k.at(1, 2);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) camera.cam_from_world.matrix()(r, c) = pose.at(r, c);
  }
  camera.Check("camera");
  return camera;
}

}  // namespace oraclegs::python
