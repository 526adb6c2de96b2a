"""Scenes: a driveline, its load, drive angles and study in one short file, and what they give."""

from cardan.app.scene.ball_joint import BallJointCase, Material
from cardan.app.scene.ball_joint_scene import BallJointScene
from cardan.app.scene.errors import SceneError
from cardan.app.scene.loading import load_scene
from cardan.app.scene.scene import Scene, SceneResult
from cardan.app.scene.states import States, StatesResult
from cardan.app.scene.streaming import stream
from cardan.app.scene.study import Axis, Column, StudyResult

__all__ = [
    "Axis",
    "BallJointCase",
    "BallJointScene",
    "Column",
    "Material",
    "Scene",
    "SceneError",
    "SceneResult",
    "States",
    "StatesResult",
    "StudyResult",
    "load_scene",
    "stream",
]
