"""A process that makes calls for the pool: from standard input, the answers to standard output, until there are no more."""

from __future__ import annotations

import os
import pickle
import signal
import sys

from talus_lab.sweep.lifetime import end_with_parent


def work() -> None:
    calls, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints must not be taken for an answer
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # puts down what it does
    end_with_parent(signal.SIGTERM)
    while True:
        try:
            function, arguments = pickle.load(calls)
        except EOFError:
            return
        try:
            answer = True, function(*arguments)
        except Exception as error:
            answer = False, error
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    work()
