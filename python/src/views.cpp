// Readers of a workspace that need the library: views, images, depth maps, proposals.

#include <nlohmann/json.hpp>

#include "bindings.h"
#include "oraclegs/depth/depth_files.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/run/start.h"
#include "oraclegs/settings/named_options.h"
#include "oraclegs/workspace/frame_file.h"

namespace oraclegs::python {
namespace {

/// The views of a run, whose workspace is free for others meanwhile.
struct RunViews {
  Scene scene;
  Split split;
  ImageOptions image;
  SceneFrame frame;

  explicit RunViews(const std::filesystem::path& workspace) {
    RunRequest request;
    request.out = workspace;
    request.version = ORACLEGS_VERSION;
    nlohmann::json saved = ReadSavedRun(workspace).options;
    for (const char* name : {"threads", "device"}) saved.erase(name);  // belong to the machine, not to the run
    SetRunOptions(saved, UnknownOption::kIgnored, &request.options);
    oraclegs::Run run = OpenRun(request, Silent());
    scene = std::move(run.scene), split = run.split, image = run.plan.image, frame = run.frame;
  }

  /// The camera in the coordinates of point_cloud.ply.
  Camera WrittenCamera(Camera camera) const {
    camera.cam_from_world = Moved(camera.cam_from_world, WrittenFromRun(frame));
    return camera;
  }

  LoadedView Load(int index) const {
    if (index < 0 || static_cast<size_t>(index) >= scene.views.size()) throw py::index_error("no such view");
    const py::gil_scoped_release release;
    return LoadViews(scene, {index}, image, Silent()).front();
  }
};

py::list ListViews(const RunViews& views) {
  py::list list;
  for (const auto& [role, indices] : {std::pair{"train", views.split.train}, std::pair{"test", views.split.test}}) {
    for (const int i : indices) {
      const SceneView& view = views.scene.views[static_cast<size_t>(i)];
      list.append(py::make_tuple(i, view.name, role, CameraTuple(views.WrittenCamera(WorkingCamera(view, views.image))),
                                 view.image_path));
    }
  }
  return list;
}

/// Returns (rgb [H,W,3], mask [H,W] bool or None).
py::tuple LoadView(const RunViews& views, int index) {
  const LoadedView view = views.Load(index);
  py::object mask = py::none();
  if (!view.mask.empty()) mask = ToArray({view.rgb.height, view.rgb.width}, view.mask.data()).attr("astype")("bool");
  return py::make_tuple(ToArray(view.rgb), mask);
}

/// Returns (inverse depth [H,W], confidence [H,W], normals [H,W,3]).
py::tuple LoadDepth(const RunViews& views, int index, const std::filesystem::path& depth) {
  const SceneView& view = views.scene.views.at(static_cast<size_t>(index));
  const Camera camera = WorkingCamera(view, views.image);
  std::vector<DepthMap> maps;
  {
    const py::gil_scoped_release release;
    maps = ReadDepthMaps(depth, {view.name}, {camera});  // in the units of point_cloud.ply
  }
  const DepthMap& map = maps.front();
  const py::ssize_t h = camera.height, w = camera.width;
  return py::make_tuple(ToArray({h, w}, map.inv_depth.data()), ToArray({h, w}, map.confidence.data()),
                        ToArray({h, w, 3}, map.normals.front().data()));
}

/// Cameras in the coordinates of point_cloud.ply.
py::list ListTargets(const std::filesystem::path& dir, const std::filesystem::path& frame_file) {
  const SceneFrame frame = ReadFrame(frame_file).value_or(SceneFrame());
  const Similarity written_from_scene = WrittenFromRun(frame) * RunFromScene(frame);
  py::list list;
  for (Target& target : ReadTargets(dir)) {
    target.camera.cam_from_world = Moved(target.camera.cam_from_world, written_from_scene);
    list.append(py::make_tuple(target.name, CameraTuple(target.camera)));
  }
  return list;
}

py::array_t<float> ReadImageArray(const std::filesystem::path& path) {
  ImageF image;
  {
    const py::gil_scoped_release release;
    image = ToFloat(ReadImage(path));
  }
  return ToArray(image);
}

}  // namespace

void BindViews(py::module_& m) {
  py::class_<RunViews>(m, "RunViews")
      .def(py::init<const std::filesystem::path&>(), py::call_guard<py::gil_scoped_release>())
      .def("views", &ListViews)
      .def("load", &LoadView)
      .def("depth", &LoadDepth);
  m.def("targets", &ListTargets);
  m.def("read_image", &ReadImageArray);
}

}  // namespace oraclegs::python
