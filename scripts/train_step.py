"""One optimisation step (forward, backward, Adam): `ctsn bench --train` against PyTorch with PyTorch Geometric.

Python is needed for this comparison only:  pip install torch torch_geometric numpy
    python scripts/train_step.py [--ctsn target/release/ctsn] [--vertices 4000 5000] [--rounds 5] [--threads 2]

Both take the mesh, the sizes and the batch from the model file that `ctsn bench --write-model` leaves. Runs
alternate, so that whatever else the machine does slows both; the ratio is the median over the rounds. On a busy
machine, --cpu compares the processor time of one thread instead of the elapsed time. PyTorch runs the batch both as
one disjoint union of graphs and pose by pose; the faster of the two counts.
"""

import argparse, json, os, re, resource, statistics, struct, subprocess, tempfile, time

import numpy as np
import torch
from torch import nn
from torch_geometric.nn import TransformerConv

BATCH = 8
STEPS = 20


def tensors(path):
    """A safetensors file: name -> array, and the model's JSON."""
    with open(path, "rb") as file:
        header = json.loads(file.read(struct.unpack("<Q", file.read(8))[0]))
        start, kinds = file.tell(), {"F32": np.float32, "U32": np.uint32}
        bytes_ = file.seek(0) or file.read()
    meta = json.loads(header.pop("__metadata__")["ctsn"])
    view = lambda t: np.frombuffer(bytes_, kinds[t["dtype"]], int(np.prod(t["shape"])), start + t["data_offsets"][0])
    return {name: torch.tensor(view(t).reshape(t["shape"]).astype(np.int64 if t["dtype"] == "U32" else np.float32)) for name, t in header.items()}, meta


def mlp(file, name):
    """Linear layers `name.0`, `name.1`, … of the file's sizes."""
    count = sum(key.startswith(f"{name}.") and key.endswith(".weight") for key in file)
    shapes = [file[f"{name}.{i}.weight"].shape for i in range(count)]
    return nn.ModuleList(nn.Linear(inputs, outputs) for outputs, inputs in shapes)


def walks(compass):
    """compass [n, 4] -> the vertices around each [n, 16], and what their distances are divided by [16, 1]."""
    at, around, ends = torch.arange(len(compass)).unsqueeze(1).repeat(1, 4), [], [1, 3, 8, 20]
    for step in range(1, ends[-1] + 1):
        at = compass[at, torch.arange(4)]
        around += [at] if step in ends else []
    return torch.cat(around, 1), 0.2 * torch.tensor(ends, dtype=torch.float32).repeat_interleave(4).unsqueeze(1)


def lbs(blended, points):
    """blended [b, n, 3, 4], points [b, n, 3] -> [b, n, 3]."""
    return (blended[..., :3] @ points.unsqueeze(-1)).squeeze(-1) + blended[..., 3]


class Network(nn.Module):
    """network.md in PyTorch."""

    def __init__(self, file, heads, edge_scale):
        super().__init__()
        parameter = lambda name: nn.Parameter(file[name].clone())
        self.skin, self.skeleton, self.mesh = (parameter(name) for name in ["cloth.weights", "skeleton.basis", "mesh.basis"])
        self.embedding, self.vertex = mlp(file, "embedding"), mlp(file, "vertex")
        layers = [file[f"graph.{l}.query.weight"].shape for l in range(sum(key.endswith(".query.weight") for key in file))]
        conv = lambda features, inputs: TransformerConv(inputs, features // heads, heads=heads, beta=True, edge_dim=6)
        self.layers = nn.ModuleList(conv(*shape) for shape in layers)
        self.norms = nn.ModuleList(nn.LayerNorm(features) for features, _ in layers)
        self.rest = file["cloth.rest"]
        self.around, self.steps = walks(file["graph.compass"])
        self.mean, self.std, self.scale = file["reference.mean"], file["reference.std"], edge_scale
        t = file["cloth.triangles"]
        edges = torch.cat([t[:, pair] for pair in ([0, 1], [1, 2], [2, 0], [1, 0], [2, 1], [0, 2])])
        self.edges = torch.unique(edges, dim=0).T.contiguous()

    def blend(self, transforms):
        """transforms [b, J, 12] -> those of the vertices [b, n, 3, 4]."""
        b, joints, _ = transforms.shape
        return (self.skin @ transforms.transpose(0, 1).reshape(joints, b * 12)).view(-1, b, 3, 4).transpose(0, 1)

    def seen(self, blended, x):
        """What is around each vertex of the coarse cloth x [b, n, 3]: h of the first layer [b, n, 54]."""
        linear, x_e, rest_e = blended[..., :3], x / self.scale, self.rest / self.scale
        way = x_e[:, self.around] - x_e.unsqueeze(2)
        strain = way @ linear - (rest_e[self.around] - rest_e.unsqueeze(1))
        return torch.cat([(x - self.mean) / self.std, linear[:, :, 1], (strain / self.steps).flatten(2)], 2)

    def forward(self, pose, transforms):
        b, n = pose.shape[0], self.rest.shape[0]
        p = pose
        for i, layer in enumerate(self.embedding):
            p = layer(p) if i + 1 == len(self.embedding) else torch.relu(layer(p))
        coarse = self.rest + torch.einsum("bm,mnc->bnc", p, self.skeleton)
        blended = self.blend(transforms)
        with torch.no_grad():
            v = lbs(blended, coarse)
            h = self.seen(blended, v).view(b * n, -1)
            offsets = (torch.arange(b) * n).view(1, b, 1)
            edges = (self.edges.unsqueeze(1) + offsets).view(2, -1)
            source, target = edges
            both = torch.cat([v.reshape(-1, 3), self.rest.repeat(b, 1)], 1) / self.scale
            features = both[source] - both[target]
        for layer, norm in zip(self.layers, self.norms):
            h = torch.relu(norm(layer(h, edges, features)))
        for layer in self.vertex:
            h = torch.relu(layer(h))
        residual = torch.einsum("bnk,knc->bnc", h.view(b, n, -1), self.mesh)
        fine = coarse.detach() + residual
        return lbs(blended, coarse), lbs(blended, fine)


def stepper(file, meta):
    """A function that runs one step, `groups` forward and backward passes for the batch."""
    network = Network(file, meta["heads"], meta["edge_scale"])
    adam = torch.optim.Adam(network.parameters(), 1e-3)
    joints, n = file["cloth.weights"].shape[1], file["cloth.rest"].shape[0]
    pose, truth = torch.randn(BATCH, 12 * joints), file["cloth.rest"] + 0.02 * torch.randn(BATCH, n, 3)
    transforms = torch.eye(3, 4).reshape(12) + 0.05 * torch.randn(BATCH, joints, 12)

    def step(groups):
        adam.zero_grad()
        for part in torch.arange(BATCH).chunk(groups):
            coarse, fine = network(pose[part], transforms[part])
            distance = lambda x: (x - truth[part]).norm(dim=-1).mean()
            ((distance(coarse) + distance(fine)) / groups).backward()
        adam.step()

    return step, network.edges.shape[1], n


def ours(bench, environment, cpu):
    """Milliseconds per step of `ctsn bench --train`, which takes STEPS of them."""

    def run(arguments):
        start = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        out = subprocess.run(arguments, check=True, capture_output=True, text=True, env=environment).stdout
        return out, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - start

    out, seconds = run([*bench, "--train"])
    if cpu:
        return 1e3 * (seconds - run(bench)[1]) / STEPS
    return float(re.search(r"training\s+([\d.]+) ms", out).group(1))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--ctsn", default="target/release/ctsn")
    parser.add_argument("--vertices", type=int, nargs="+", default=[4000, 5000])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--cpu", action="store_true")
    arguments = parser.parse_args()
    threads, clock = (1, time.process_time) if arguments.cpu else (arguments.threads, time.perf_counter)
    torch.set_num_threads(threads)
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    for vertices in arguments.vertices:
        bench = [arguments.ctsn, "bench", "--vertices", str(vertices), "--runs", "1"]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "model.safetensors")
            subprocess.run([*bench, "--write-model", path], check=True)
            step, edges, n = stepper(*tensors(path))
        rounds = []
        for groups in (1, BATCH):
            step(groups)
        for _ in range(arguments.rounds):
            rust, times = ours(bench, environment, arguments.cpu), {}
            for groups in (1, BATCH):
                samples = []
                for _ in range(3):
                    start = clock()
                    step(groups)
                    samples.append(1e3 * (clock() - start))
                times[groups] = statistics.median(samples)
            rounds.append((rust, times[1], times[BATCH], min(times.values()) / rust, os.getloadavg()[0]))
            print("n %d: ctsn %.1f ms, PyTorch as one %.1f ms, pose by pose %.1f ms, ratio %.2f (load %.1f)" % (n, *rounds[-1]), flush=True)
        medians = [statistics.median(column) for column in zip(*rounds)]
        print("n %d, %d edges, %d threads, torch %s: medians ctsn %.1f ms, PyTorch as one %.1f ms, pose by pose %.1f ms; ratio %.2f" % (n, edges, threads, torch.__version__, *medians[:4]), flush=True)


if __name__ == "__main__":
    main()
