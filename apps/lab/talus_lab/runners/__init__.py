"""Programs that compute a scene of docs/runners.md with another library, one module each: `python -m talus_lab.runners.chipmunk IN OUT`."""
