"""Robots in asyncio: any number of coroutines beside each other, each of which sees every frame.

    async with asyncio.TaskGroup() as group:
        group.create_task(steer(robot))
        group.create_task(watch(robot))

    async def watch(robot):
        async for state in aio.states(robot):
            ...

Not in virtual time, which passes only in Robot.wait(). Functions of a robot that take long can be
called with asyncio.to_thread(): end(), close() and a second start().
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import threading
import weakref
from collections.abc import AsyncIterator
from typing import Any

from . import _arguments
from ._arguments import Path, Seconds
from ._callbacks import Progress
from .errors import Error, TimedOut, UnsupportedError
from .events import Event
from .records import State
from .robot import Robot

# The descriptor reports what the loop does. That it has stalled is found by a look.
_LOOK_S = 0.25
_AT_ONCE = 64


class _Waker:
    """The one reader of a robot's descriptor: wakes the coroutines of one event loop."""

    def __init__(self, descriptor: int) -> None:
        # Its own, so that a number that the robot gives back when it is closed is never read.
        self._descriptor = os.dup(descriptor)
        self._loop: asyncio.AbstractEventLoop | None = None  # the last that has awaited
        self._listening = False
        self._waiting: set[asyncio.Future[None]] = set()

    def __del__(self) -> None:
        os.close(self._descriptor)

    async def wait(self, timeout_s: float) -> None:
        """Until something has come, or so long."""
        loop = asyncio.get_running_loop()
        if loop is not self._loop or not self._listening:
            self._listen(loop)
        woken: asyncio.Future[None] = loop.create_future()
        self._waiting.add(woken)
        try:
            async with asyncio.timeout(timeout_s):
                await woken
        except TimeoutError:
            pass
        finally:
            self._waiting.discard(woken)

    def _listen(self, loop: asyncio.AbstractEventLoop) -> None:
        before = self._loop
        if before is not None and before is not loop:
            if before.is_running():
                raise RuntimeError("another event loop awaits this robot")
            if self._listening and not before.is_closed():
                before.remove_reader(self._descriptor)
        loop.add_reader(self._descriptor, self._readable)
        self._loop, self._listening = loop, True

    def _readable(self) -> None:
        with contextlib.suppress(BlockingIOError):
            os.read(self._descriptor, 8)
        if not self._waiting and self._loop is not None:  # nobody awaits: it need not look
            self._loop.remove_reader(self._descriptor)
            self._listening = False
        for woken in self._waiting:
            if not woken.done():
                woken.set_result(None)


_wakers: weakref.WeakKeyDictionary[Robot, _Waker] = weakref.WeakKeyDictionary()


def _waker_of(robot: Robot) -> _Waker:
    _arguments.instance("robot", robot, Robot)
    waker = _wakers.get(robot)
    if waker is None:
        try:
            waker = _Waker(robot.fd)
        except UnsupportedError:
            raise UnsupportedError("virtual time passes only in Robot.wait(), so there is nothing "
                                   "to await; use Robot.states(), or a Sim in real time") from None
        _wakers[robot] = waker
    return waker


async def wait(robot: Robot, after_tick: int = -1,
               timeout_s: Seconds | None = None) -> State | None:
    """As Robot.wait(), while other coroutines run."""
    waker = _waker_of(robot)
    loop = asyncio.get_running_loop()
    timeout_ns = _arguments.timeout_ns("timeout_s", timeout_s)
    limit = None if timeout_ns is None else loop.time() + timeout_ns / 1e9
    while True:
        try:
            return robot.wait(after_tick, 0.0)
        except TimedOut:
            left_s = _LOOK_S if limit is None else min(_LOOK_S, limit - loop.time())
            if left_s <= 0.0:
                raise
        await waker.wait(left_s)


async def states(robot: Robot, *, after_tick: int = -1) -> AsyncIterator[State]:
    """Every state after `after_tick` (-1: from the newest on), until the loop is asked to end.

    A coroutine that falls behind gets those that it has missed, up to 256, 3.8 s: then `skipped`
    says how many are gone. If the loop ends by itself, raises why, as Robot.wait() does.
    """
    newest = await wait(robot, after_tick)
    if newest is not None and after_tick < 0:
        yield newest
        after_tick = newest.tick
    while newest is not None:
        for state in robot.history(after_tick, _AT_ONCE):
            yield state
            after_tick = state.tick
        newest = await wait(robot, after_tick)


async def events(robot: Robot, *, after_sequence: int = 0) -> AsyncIterator[Event]:
    """Every event after the one of that number, until the loop has ended."""
    waker = _waker_of(robot)
    while True:
        ended = robot.end_report.ended  # before the look: the last events come before the end
        for event in robot.events(after_sequence):
            yield event
            after_sequence = event.sequence
        if ended:
            return
        await waker.wait(_LOOK_S)


async def open_robot(port: Path | None = None, *, progress: Progress | None = None,
                     **options: Any) -> Robot:
    """As Robot(), while other coroutines run; a cancelled task gives up bringing the robot up.

    `progress` is called in another thread.
    """
    given_up = threading.Event()

    def tell(step: str, detail: str) -> bool | None:
        if given_up.is_set():
            return False
        return progress(step, detail) if progress is not None else None

    opening = asyncio.ensure_future(asyncio.to_thread(Robot, port, progress=tell, **options))
    try:
        return await asyncio.shield(opening)
    except asyncio.CancelledError:
        given_up.set()
        with contextlib.suppress(Error):
            (await opening).close()
        raise
