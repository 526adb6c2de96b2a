"""Common parts of pictures, and pictures of joints and drivelines without a scene."""
