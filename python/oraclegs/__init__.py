"""OracleGS from Python: a few photos become a 3D Gaussian splat.

    import oraclegs
    metrics = oraclegs.reconstruct("photos/", "out/", iterations=500)
    workspace = oraclegs.Workspace("out/")
    image = oraclegs.render(workspace.gaussians, workspace.views[0].camera)

Arrays are NumPy's, float32 unless said otherwise. Images are RGB in [0, 1], rows from top to bottom. Cameras are
world-to-camera with x right, y down, z forward, as COLMAP and OpenCV have them; pixel (0, 0) has its center at
(0.5, 0.5).
"""

from ._core import Error, InputError, Interrupted, OutOfMemory, RunError, UsageError, __version__
from .camera import Camera
from .run import option_names, reconstruct
from .splat import Splat, read_splat, render
from .workspace import DepthMap, Proposal, View, Workspace

__all__ = ["Camera", "DepthMap", "Error", "InputError", "Interrupted", "OutOfMemory", "Proposal", "RunError", "Splat", "UsageError",
           "View", "Workspace", "__version__", "option_names", "read_splat", "reconstruct", "render"]  # fmt: skip
