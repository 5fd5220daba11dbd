#!/usr/bin/env python3
"""Shows the curves of a run in TensorBoard, or with --wandb in Weights & Biases, while it trains and afterwards.

    oraclegs reconstruct photos/ -o out/ --eval --eval-every 200 &
    python3 follow.py out/ && tensorboard --logdir out/tensorboard
"""

import csv
import sys
import time
from pathlib import Path

out, use_wandb = Path(sys.argv[1]), "--wandb" in sys.argv
if use_wandb:
    import wandb

    log = wandb.init(project="oraclegs", name=out.resolve().name).log
else:
    from torch.utils.tensorboard import SummaryWriter

    writer = SummaryWriter(out / "tensorboard")

    def log(values, step):
        for name, value in values.items():
            writer.add_scalar(name, value, step)


last = -1
while True:
    ended = (out / "metrics.json").exists()  # asked first: the last rows are there then
    with open(out / "train.csv") as file:
        for row in csv.DictReader(file):
            step = int(row.pop("iteration"))
            if step > last:
                log({name: float(value) for name, value in row.items() if value}, step=step)
                last = step
    if ended:
        break
    time.sleep(5)
