"""One engine of `npm run bench -- --peers`: onnxruntime, natively.

    python peers.py MODEL.onnx POSES POSITIONS THREADS

POSES: float32 [P, J, 3, 4] as raw bytes. Writes the positions of the last of them as raw bytes. Prints JSON:
milliseconds from the start of loading to the first prediction, the median of the others, and the process's greatest
memory in bytes.
"""

import json
import resource
import statistics
import sys
import time

import numpy
import onnxruntime

model, poses, positions, threads = sys.argv[1:]
start = time.perf_counter()
options = onnxruntime.SessionOptions()
options.intra_op_num_threads = int(threads)
session = onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])
shape = session.get_inputs()[0].shape
done = []
for joints in numpy.fromfile(poses, numpy.float32).reshape(-1, *shape):
    (found,) = session.run(None, {"joints": joints})
    done.append(time.perf_counter())
found.tofile(positions)
each = statistics.median(1e3 * (b - a) for a, b in zip(done, done[1:]))
memory = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({"load": 1e3 * (done[0] - start), "each": each, "memory": memory}))
