"""The commands of `talus-lab`, one module for each group. `add` declares their options; what a command needs is loaded when it is called,
so that the others, and `--help`, do not wait for it."""
