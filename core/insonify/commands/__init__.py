"""Sub-commands of ``insonify``, one module each.

A module named after its command has ``register(subparsers)``, which adds the parser and sets its ``run``: a function of
the parsed arguments, which may return an exit code. Modules are found by being here. Installed packages announce a
``register`` as an entry point of the group ``insonify.commands``. A module imports what its command needs within
``run``, so that other commands start quickly. A command of the lists below is loaded only when it is run.
"""

OWN = {
    "budget": "print the sonar equation of a scene",
    "chart": "measure speed against accuracy on this machine",
    "compare": "draw two records side by side, with histograms and spectra",
    "dataset": "make a labelled data set by its specification",
    "exercise": "make an exercise of a survey with hidden targets, or mark what was found",
    "explain": "explain one pixel of a scene's record",
    "info": "describe measured casts and recorded navigation",
    "learn": "estimate a scene from a recording",
    "lesson": "list the lessons of the viewer, or check lessons",
    "light": "draw a scene as light shows it, with the lamp at the sonar",
    "mosaic": "put records on a map (.tif)",
    "plan": "explain how a scene would be simulated",
    "rays": "draw rays, shadow zones and caustics",
    "realism": "compare the texture of two folders of images, real and simulated",
    "relief": "write the heights of the bed as a grey picture",
    "render": "simulate a record: .png (picture), .nc (netCDF), .npz (NumPy arrays), .zarr (Zarr), "
    ".jsf (EdgeTech JSF), .xtf (eXtended Triton Format)",
    "scenes": "list the bundled scenes, or describe some",
    "stability": "measure known numerical failures and their cures, as a page (.html)",
    "survey": "simulate a survey of many lines by its specification",
    "targets": "list the library of targets",
    "tow": "tow over a scene in real time, for survey programs: JSF, XTF, NMEA 0183, MCAP, JSON",
}
OF_VIEWER = {"view": "open the viewer", "movie": "draw a tow as a moving picture: .webp, .gif, .mp4"}
