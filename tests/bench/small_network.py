"""A small residual network that tells seabeds, ships and aircraft apart, and how its pictures are varied.

A picture is scaled until its longer side is `SIDE` pixels and stands in the middle of a square. Its greys have the mean
0 and the deviation 1, and the rest of the square the grey 0. Pictures are learned as archives may show them: closely
cropped or with much bed, turned, mirrored, longer or wider, unevenly bright, noisy, blurred, with other greys.
"""

import math

import numpy as np
import torch
from PIL import Image
from torch import nn
from torch.nn import functional

SIDE, CLASSES = 128, 3
SHARES = (4, 3, 1)  # of seabeds, ships and aircraft in a batch
BATCH = 256
PLACES = torch.linspace(-1.0 + 1.0 / SIDE, 1.0 - 1.0 / SIDE, SIDE)


def as_seen(picture: Image.Image) -> torch.Tensor:
    """Square of a picture, (1, SIDE, SIDE)."""
    scale = SIDE / max(picture.size)
    wide, high = (max(round(side * scale), 16) for side in picture.size)
    method = Image.Resampling.BOX if scale < 1.0 else Image.Resampling.BILINEAR
    greys, shown = torch.zeros(2, 1, SIDE, SIDE)
    rows, columns = (slice((SIDE - side) // 2, (SIDE - side) // 2 + side) for side in (high, wide))
    greys[0, rows, columns] = torch.from_numpy(
        np.asarray(picture.convert("L").resize((wide, high), method), np.float32)
    )
    shown[0, rows, columns] = 1.0
    return _even(greys[None] / 255.0, shown[None])[0]


def _even(greys: torch.Tensor, shown: torch.Tensor) -> torch.Tensor:
    """Greys of mean 0 and deviation 1 where a picture is shown, 0 elsewhere."""
    count = shown.sum((2, 3), keepdim=True)
    greys = (greys - (greys * shown).sum((2, 3), keepdim=True) / count) * shown
    return greys / ((greys**2).sum((2, 3), keepdim=True) / count).sqrt().add(1e-3)


class Changes:
    """Random changes of a batch of square chips, (n, 1, s, s), whose boxes (n, 4) hold an echo and its shadow."""

    def __init__(self, random: torch.Generator) -> None:
        self._random = random

    def _uniform(self, count: int, low: float, high: float) -> torch.Tensor:
        drawn = torch.rand(count, generator=self._random)
        return (low + (high - low) * drawn).view(-1, 1, 1, 1)

    def _normal(self, *shape: int) -> torch.Tensor:
        return torch.randn(*shape, generator=self._random)

    def _some(self, count: int, chance: float) -> torch.Tensor:
        return self._uniform(count, 0.0, 1.0) < chance

    def __call__(self, chips: torch.Tensor, boxes: torch.Tensor) -> torch.Tensor:
        greys, shown = self._framed(chips, self._windows(len(chips), chips.shape[3], boxes))
        return self._covered(_even(self._displayed(self._recorded(greys)), shown))

    def _windows(self, count: int, side: int, boxes: torch.Tensor) -> torch.Tensor:
        """Middles and half sizes of what is shown, (4, n, 1, 1, 1): the whole chip, or about its box."""
        lows, sizes = boxes[:, :2].T.reshape(2, -1, 1, 1, 1), boxes[:, 2:].T.reshape(2, -1, 1, 1, 1)
        before, after = (torch.stack([self._uniform(count, -0.06, 0.35) for _ in range(2)]) for _ in range(2))
        first = (lows - before * sizes).clamp(0.0, side - 24.0)
        last = torch.maximum((lows + sizes + after * sizes).clamp(max=float(side)), first + 20.0)
        whole = self._some(count, 0.4)
        first, last = torch.where(whole, 0.0, first), torch.where(whole, float(side), last)
        return torch.cat([first + last, last - first]) / 2.0

    def _framed(self, chips: torch.Tensor, windows: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Windows turned, mirrored and stretched; and where they lie in their squares."""
        count, side = len(chips), chips.shape[3]
        x, y, wide, high = windows
        stretch = torch.exp(self._uniform(count, -0.3, 0.3))
        quarters = torch.randint(4, (count, 1, 1, 1), generator=self._random)
        turn = quarters * (math.pi / 2.0) + math.radians(10.0) * self._normal(count, 1, 1, 1)
        wide, high = wide * stretch, high / stretch
        across, down = torch.where(quarters % 2 == 1, high, wide), torch.where(quarters % 2 == 1, wide, high)
        scale = torch.maximum(across, down)
        u, v = PLACES.view(1, 1, 1, -1) * scale, PLACES.view(1, 1, -1, 1) * scale
        shown = ((u.abs() <= across) & (v.abs() <= down)).float()
        mirror = torch.where(self._some(count, 0.5), -1.0, 1.0)
        along_x = (torch.cos(turn) * u - torch.sin(turn) * v) * mirror / stretch
        along_y = (torch.sin(turn) * u + torch.cos(turn) * v) * stretch
        places = torch.stack([x + along_x, y + along_y], -1)[:, 0] * (2.0 / side) - 1.0
        return functional.grid_sample(chips, places, padding_mode="reflection", align_corners=False), shown

    def _recorded(self, greys: torch.Tensor) -> torch.Tensor:
        """Uneven gain, more speckle, less resolution."""
        count = len(greys)
        slope = self._uniform(count, -0.6, 0.6) * PLACES.view(1, 1, 1, -1)
        slope = slope + self._uniform(count, -0.6, 0.6) * PLACES.view(1, 1, -1, 1)
        patches = functional.interpolate(self._normal(count, 1, 4, 4), size=SIDE, mode="bicubic", align_corners=False)
        greys = greys * torch.exp(slope + self._uniform(count, 0.0, 0.25) * patches)
        speckle = torch.where(self._some(count, 0.4), self._uniform(count, 0.0, 0.5), 0.0)
        greys = greys * (1.0 + speckle * self._normal(*greys.shape)).clamp(min=0.0)
        width = torch.where(self._some(count, 0.5), self._uniform(count, 0.2, 1.6), 0.05)
        kernel = torch.exp(-0.5 * (torch.arange(-4, 5) / width) ** 2)
        kernel = kernel / kernel.sum(3, keepdim=True)
        greys = greys.view(1, count, SIDE, SIDE)
        for weights, border in ((kernel, (4, 4, 0, 0)), (kernel.transpose(2, 3), (0, 0, 4, 4))):
            greys = functional.conv2d(functional.pad(greys, border, mode="reflect"), weights, groups=count)
        return greys.view(count, 1, SIDE, SIDE)

    def _displayed(self, greys: torch.Tensor) -> torch.Tensor:
        """Other black, white and gamma, noise, and now and then inverted."""
        count = len(greys)
        ranked = greys.flatten(1)[:, ::7].sort(1).values
        black, white = (
            ranked.gather(1, (share.view(-1, 1) * ranked.shape[1]).long()).view(-1, 1, 1, 1)
            for share in (self._uniform(count, 0.0, 0.08), self._uniform(count, 0.88, 0.9999))
        )
        greys = ((greys - black) / (white - black + 1e-3)).clamp(0.0, 1.0)
        greys = (greys + 1e-4) ** torch.exp(self._uniform(count, -0.7, 0.7))
        greys = torch.where(self._some(count, 0.08), 1.0 - greys, greys)
        return greys + self._uniform(count, 0.0, 0.06) * self._normal(*greys.shape)

    def _covered(self, greys: torch.Tensor) -> torch.Tensor:
        """A part of some pictures hidden, so that no single part decides."""
        count = len(greys)
        x, y, reach = self._uniform(count, -1.0, 1.0), self._uniform(count, -1.0, 1.0), self._uniform(count, 0.1, 0.35)
        hidden = ((PLACES.view(1, 1, 1, -1) - x).abs() < reach) & ((PLACES.view(1, 1, -1, 1) - y).abs() < reach)
        return torch.where(hidden & self._some(count, 0.3), 0.0, greys)


class _Residual(nn.Module):
    """Two convolutions beside the way past them (He et al. 2016)."""

    def __init__(self, channels: int, more: int, stride: int) -> None:
        super().__init__()
        self.main = nn.Sequential(
            nn.Conv2d(channels, more, 3, stride, 1, bias=False),
            nn.BatchNorm2d(more),
            nn.ReLU(),
            nn.Conv2d(more, more, 3, 1, 1, bias=False),
            nn.BatchNorm2d(more),
        )
        self.past = nn.Sequential(nn.AvgPool2d(stride), nn.Conv2d(channels, more, 1, bias=False), nn.BatchNorm2d(more))

    def forward(self, values: torch.Tensor) -> torch.Tensor:
        return functional.relu(self.main(values) + self.past(values))


def _network(width: int) -> nn.Module:
    """Eight residual blocks at four resolutions, their channels doubled at each."""
    channels = width
    layers: list[nn.Module] = [nn.Conv2d(1, width, 5, 2, 2, bias=False), nn.BatchNorm2d(width), nn.ReLU()]
    for stage in range(4):
        for part in range(2):
            more = width * 2**stage
            layers.append(_Residual(channels, more, 2 if stage > 0 and part == 0 else 1))
            channels = more
    ends = nn.AdaptiveAvgPool2d(1), nn.Flatten(), nn.Dropout(0.3), nn.Linear(channels, CLASSES)
    return nn.Sequential(*layers, *ends)


def learn(
    chips: torch.Tensor, boxes: torch.Tensor, classes: torch.Tensor, *, seed: int, steps: int, width: int
) -> nn.Module:
    """Network trained on chips, (n, 1, s, s) of bytes: the running mean of its weights."""
    torch.manual_seed(seed)
    changes = Changes(torch.Generator(chips.device).manual_seed(seed))
    of_class = [torch.nonzero(classes == number)[:, 0] for number in range(CLASSES)]
    counts = [BATCH * share // sum(SHARES) for share in SHARES]
    network = _network(width).to(memory_format=torch.channels_last)
    mean = torch.optim.swa_utils.AveragedModel(
        network, multi_avg_fn=torch.optim.swa_utils.get_ema_multi_avg_fn(0.99), use_buffers=True
    )
    optimizer = torch.optim.AdamW(network.parameters(), lr=2e-3, weight_decay=0.05)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimizer, 2e-3, total_steps=steps, pct_start=0.15)
    network.train()
    for _ in range(steps):
        picks = torch.cat([own[torch.randint(len(own), (count,))] for own, count in zip(of_class, counts, strict=True)])
        shown = changes(chips[picks].float() / 255.0, boxes[picks])
        with torch.autocast(chips.device.type, torch.bfloat16, enabled=chips.is_cuda):
            told = network(shown)
        loss = functional.cross_entropy(told.float(), classes[picks], label_smoothing=0.05)
        optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(network.parameters(), 2.0)
        optimizer.step()
        rate.step()
        mean.update_parameters(network)
    return mean.eval()


@torch.no_grad()
def chances(network: nn.Module, seen: torch.Tensor) -> np.ndarray:
    """Chances of the classes, (n, 3): means over the quarter turns of a picture and their mirror images."""
    turned = [torch.rot90(side, quarter, (2, 3)) for side in (seen, seen.flip(3)) for quarter in range(4)]
    told = [torch.cat([network(part).float().softmax(1) for part in one.split(BATCH)]) for one in turned]
    return torch.stack(told).mean(0).cpu().numpy()
