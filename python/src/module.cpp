// The extension module oraclegs._core: converts arguments, calls the library, converts results. The classes that users
// see are in python/oraclegs/.

#include "bindings.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/formats/splat_file.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/render/render.h"

namespace oraclegs::python {
namespace {

py::dict ReadSplatArrays(const std::filesystem::path& path) {
  GaussianPly splat;
  {
    const py::gil_scoped_release release;
    splat = ReadSplat(path);
  }
  for (const std::string& warning : splat.warnings) {
    if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 2) != 0) throw py::error_already_set();
  }
  py::dict arrays;
  splat.gaussians.ForEach([&](const char* name, const Buffer<float>& buffer) { arrays[name] = ToArray(buffer); });
  arrays["sh_degree"] = splat.sh_degree;
  arrays["comments"] = splat.comments;
  arrays["antialiased"] = splat.antialiased;
  arrays["uncertainty"] =
      splat.marks.uncertainty.empty()
          ? py::object(py::none())
          : ToArray({static_cast<py::ssize_t>(splat.marks.uncertainty.size())}, splat.marks.uncertainty.data());
  arrays["support"] = splat.marks.support.empty()
                          ? py::object(py::none())
                          : ToArray({static_cast<py::ssize_t>(splat.marks.support.size())}, splat.marks.support.data());
  return arrays;
}

Gaussians GaussiansFrom(const Array<float>& means, const Array<float>& log_scales, const Array<float>& quats,
                        const Array<float>& opacity_logits, const Array<float>& sh) {
  const int64_t n = means.ndim() > 0 ? means.shape(0) : 0;
  return {ToBuffer("means", means, {-1, 3}), ToBuffer("log_scales", log_scales, {n, 3}),
          ToBuffer("quats", quats, {n, 4}), ToBuffer("opacity_logits", opacity_logits, {n}),
          ToBuffer("sh", sh, {n, 16, 3})};
}

py::array_t<float> Render(const Array<float>& means, const Array<float>& log_scales, const Array<float>& quats,
                          const Array<float>& opacity_logits, const Array<float>& sh, const Array<double>& k,
                          const Array<double>& world_to_camera, int width, int height, int sh_degree,
                          std::array<float, 3> background, bool antialiased) {
  const Gaussians gaussians = GaussiansFrom(means, log_scales, quats, opacity_logits, sh);
  const Camera camera = CameraFrom(k, world_to_camera, width, height);
  if (width > kMaxRenderSide || height > kMaxRenderSide) {
    throw UsageError("an image of {} x {} pixels cannot be rendered, at most {} a side", width, height, kMaxRenderSide);
  }
  if (sh_degree < 0 || sh_degree > kMaxShDegree) throw UsageError("sh_degree is {}, must be in 0 .. 3", sh_degree);
  std::unique_ptr<Rasterizer> rasterizer;
  RenderOutput out;
  {
    const py::gil_scoped_release release;
    rasterizer = MakeRasterizer(kCpu);
    out = rasterizer->Forward(gaussians, camera, {background, sh_degree, antialiased}, RenderPass::kInference);
  }
  return ToArray(out.image);
}

void BindErrors(py::module_& m) {
  const auto error = py::register_exception<Error>(m, "Error");
  py::register_exception<UsageError>(m, "UsageError", error);
  py::register_exception<InputError>(m, "InputError", error);
  const auto run = py::register_exception<RunError>(m, "RunError", error);
  py::register_exception<OutOfMemory>(m, "OutOfMemory", run);
  py::register_exception<Interrupted>(m, "Interrupted", error);
}

}  // namespace
}  // namespace oraclegs::python

PYBIND11_MODULE(_core, m) {
  using namespace oraclegs::python;
  m.doc() = "The library behind the package oraclegs.";
  m.attr("__version__") = ORACLEGS_VERSION;
  BindErrors(m);
  BindRun(m);
  BindViews(m);
  m.def("read_splat", &ReadSplatArrays, py::arg("path"));
  m.def("render", &Render);
  m.def("set_threads", &oraclegs::SetNumThreads, py::arg("threads"));
}
