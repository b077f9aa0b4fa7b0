"""The rays of a picture, worked out beside the kernels."""

import numpy as np

from thurston_cl.scene.placement import CameraFrame


def view(camera: CameraFrame, size: tuple[int, int], fov: float) -> np.ndarray:
    """Directions (H*W,3) through the middles of the pixels of a picture of `size` (width, height), in
    perspective of the angle `fov`, in radians, from bottom to top.
    """
    width, height = size
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    scale = 2 * np.tan(fov / 2) / height
    across, upwards = (x - width / 2) * scale, (height / 2 - y) * scale
    u = np.stack([across, upwards, np.ones_like(across)], axis=-1).reshape(-1, 3) @ camera.frame
    return u / np.linalg.norm(u, axis=1, keepdims=True)
