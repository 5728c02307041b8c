"""The tow of a scene as a moving picture: the seabed in 3-D beside its record, which grows ping by ping."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image
from PySide6.QtCore import QEventLoop
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QDockWidget, QToolBar

from insonify.arrays import Bytes
from insonify.io.atomic import replacing
from insonify.scene import Scene, SceneError, edit
from insonify_viewer.application import main_thread_collection, make_application, wait_for_picture
from insonify_viewer.viewer import Viewer

RATE = 12  # pictures per second
WEBP_QUALITY = 60  # of 100
VIDEO = ".mp4"
MOST_BYTES = 2 * 10**9  # of pictures that are held while a file that repeats is written

Picture = Bytes  # (height, width, 3)


class View(NamedTuple):
    """What one picture shows: the newest ping, and fields of the scene that have other values by then."""

    ping: int
    changes: Mapping[str, Any] = {}


def tow_views(scene: Scene, seconds: float) -> list[View]:
    """Return the views of a tow along the whole track of a scene."""
    pings = np.linspace(0.0, scene.track.pings - 1, max(round(RATE * seconds), 2) + 1)[1:]
    return [View(round(ping)) for ping in pings]


def check_room(path: Path, pictures: int, size: tuple[int, int]) -> None:
    """Raise SceneError for a movie that would be held whole in more memory than `MOST_BYTES`."""
    needed = 3 * pictures * size[0] * size[1]
    if path.suffix.lower() != VIDEO and needed > MOST_BYTES:
        most = MOST_BYTES / (3 * RATE * size[0] * size[1])
        raise SceneError(
            f"{path.name}: {pictures} pictures of {size[0]} x {size[1]} take {needed / 1e9:.1f} GB of memory; write "
            f"{VIDEO}, or at most --seconds {most:.0f}"
        )


def draw_views(scene: Scene, size: tuple[int, int], views: Iterable[View]) -> Iterator[Picture]:
    """Yield a picture of seabed and record for every view, (height, width, 3); needs no screen."""
    # Changes that no scene can have raise SceneError.
    application = make_application()
    with main_thread_collection():
        viewer = Viewer(scene, accelerated=False)
        window = viewer.window
        shown = window.centralWidget()
        assert shown is not None
        window.may_close = lambda: True  # changes of the views are not asked about
        bars = window.menuBar(), window.statusBar(), *window.findChildren(QToolBar)
        for part in (*bars, *window.findChildren(QDockWidget)):
            part.hide()
        window.resize(*size)
        window.show()
        viewer.tow.run(False)
        viewer.start()
        try:
            for view in views:
                if view.changes:
                    changed = edit(viewer.session.scene, view.changes)
                    viewer.session.turn_to(changed, viewer.session.modelling)
                viewer.go_to(view.ping)
                wait_for_picture(application, viewer, rest=0.0)  # panels are hidden
                viewer.seabed.draw_now()
                application.processEvents(QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents)
                yield _array_of(shown.grab().toImage())
        finally:
            window.close()


def write_movie(path: Path, pictures: Iterable[Picture]) -> None:
    """Write pictures as GIF or WebP, which repeat, or as MP4 (H.264), by the suffix of the path."""
    with replacing(path) as beside:
        if path.suffix.lower() == VIDEO:
            _write_video(beside, iter(pictures))
            return
        images = [Image.fromarray(picture) for picture in pictures]
        options: dict[str, Any] = {"quality": WEBP_QUALITY, "method": 4}
        if path.suffix.lower() == ".gif":
            # One palette for all pictures, without dithering: what rests stays as it is, and compresses.
            palette = images[len(images) // 2].quantize(256)
            images, options = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images], {}
        duration = round(1000 / RATE)
        images[0].save(beside, save_all=True, append_images=images[1:], duration=duration, loop=0, **options)


def _write_video(path: Path, pictures: Iterator[Picture]) -> None:
    try:
        # lazy: an optional package
        from imageio_ffmpeg import write_frames
    except ImportError as error:
        raise SceneError(
            f"{path.suffix}: needs imageio-ffmpeg; install it by 'pip install imageio-ffmpeg', or write .webp or .gif"
        ) from error
    first = next(pictures)
    height, width = first.shape[:2]
    writer = write_frames(str(path), (width, height), fps=RATE, quality=7, macro_block_size=2)
    with closing(writer):  # which waits for the encoder, and ends it after an error
        writer.send(None)
        for picture in chain([first], pictures):
            writer.send(picture)


def _array_of(image: QImage) -> Picture:
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).copy()
