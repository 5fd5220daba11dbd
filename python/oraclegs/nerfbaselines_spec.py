"""Registration of the method in NerfBaselines: NERFBASELINES_REGISTER names this file. Its backend is `python`: the package
oraclegs stands in the environment that runs NerfBaselines."""

from nerfbaselines import register

register({
    "id": "oraclegs",
    "method_class": "oraclegs.nerfbaselines:OracleGS",
    "backends_order": ["python"],
    "metadata": {
        "name": "OracleGS",
        "description": "Gaussian splats of a few photos: views are proposed, checked by an oracle, and trained on as far as they can be trusted.",
    },
    "required_features": ["color"],
    "supported_camera_models": ["pinhole"],
    "supported_outputs": ["color"],
    "presets": {"blender": {"@apply": [{"dataset": "blender"}], "background": "white"}},
})  # fmt: skip
