"""The command ``cardan`` as ``python -m cardan``."""

from cardan.app.command import main

if __name__ == "__main__":
    main()
