# SPDX-License-Identifier: MIT
"""Replays traces of threads_traced.cpp on P workers: predicted wall time, speed-up, and where time is lost.

Each P is replayed from the trace whose run was planned for the nearest number of threads. Memory bandwidth, disks and
clocks of processors that change with their load are left out."""
import bisect
import collections
import heapq
import json
import math
import re
import struct
import subprocess
import sys

(LOOP, LOOP_END, ITER, ITER_END, SPAWN, TASK, TASK_END, WAIT, WAIT_END, LOCK, UNLOCK, CALL, CALL_END, CALLED,
 CALLED_END) = range(1, 16)
# Operations of a task: (W, ns, segment), (L, loop), (S, task), (B, task), (A, mutex), (R, mutex), (C, task)
W, L, S, B, A, R, C = range(7)
LOOPS = ('parallel_for', 'with_threads', 'BackgroundTask::BackgroundTask', 'BackgroundTask::wait')


# ---- names ------------------------------------------------------------------------------------------------------
def without_brackets(text, opening, closing):
    out, depth, i = [], 0, 0
    while i < len(text):
        c = text[i]
        if c == opening and not text.startswith('operator<', max(0, i - 8)):
            depth += 1
        elif c == closing and depth and text[i - 1] != '-':
            depth -= 1
        elif not depth:
            out.append(c)
        i += 1
    return ''.join(out)


def short(name):
    name = name.replace('(anonymous namespace)::', '').replace('[abi:cxx11]', '')
    inner = re.match(r'(?:void )?std::_Function_handler<.*?\)?, (pointsweep::.*)>::_M_(?:invoke|manager)', name)
    if inner:
        name = inner.group(1)
    name = re.sub(r'\{lambda\((?:[^(){}]|\([^()]*\))*\)#\d+\}', 'λ', name)
    name = without_brackets(name, '<', '>')
    name = re.sub(r' \[clone [^\]]*\]', '', name)
    name = without_brackets(name, '(', ')')
    name = re.sub(r'\b(const|noexcept)\b', '', name).replace('pointsweep::', '').replace('::operator', '').strip()
    name = re.sub(r'λ.*', 'λ', name)
    return name.split(' ')[-1] or '?'


class Names:
    """Functions by address, from the symbols of the binary and of its libraries."""

    def __init__(self, modules):
        self.modules, self.tables, self.known = modules, {}, {}

    def table(self, m):
        if m not in self.tables:
            path, rows = self.modules[m][2], []
            flags = ['-CS'] if m == 0 else ['-CSD']
            got = subprocess.run(['nm', *flags, '--defined-only', path], capture_output=True, text=True).stdout
            for line in got.splitlines():
                part = line.split(' ', 3)
                if len(part) == 4 and part[2] in 'tTwWiu':
                    rows.append((int(part[0], 16), int(part[1], 16), part[3]))
            rows.sort()
            self.tables[m] = [r[0] for r in rows], rows
        return self.tables[m]

    def of(self, address):
        """Returns (whether the function at an address is in the program itself, its name)."""
        if address not in self.known:
            self.known[address] = self.find(address)
        return self.known[address]

    def find(self, address):
        for m, (base, end, path) in enumerate(self.modules):
            if base <= address < end:
                starts, rows = self.table(m)
                i = bisect.bisect_right(starts, address - base) - 1
                name = rows[i][2] if i >= 0 and address - base < rows[i][0] + max(rows[i][1], 1) else '?'
                if m:
                    lib = path.rsplit('/', 1)[-1].split('.so')[0]
                    return False, lib + ':' + (lib if name == '?' else name.split('@')[0].split('(')[0])
                return 'pointsweep::' in name and 'span_trace' not in name, short(name)
        return False, '?'

    def chain(self, frames, deep=3):
        """The innermost functions of the program, leaf first, with the library call they are in."""
        own, lib = [], ''
        for i, address in enumerate(frames):
            if not address:
                break
            ours, name = self.of(address - 1 if i else address)
            if ours:
                if name in LOOPS:
                    own = []  # leaves out the functions of the loop itself, so that its caller is the innermost function
                    continue
                if name.startswith(tuple(loop + '::' for loop in LOOPS)):
                    continue
                if not own or own[-1] != name:
                    own.append(name)
            elif not own and name.startswith('lib') and not lib and 'libtbb' not in name:
                lib = name.split(':')[-1].lstrip('_')
            if len(own) == deep:
                break
        return tuple(own), lib


# ---- the trace --------------------------------------------------------------------------------------------------
class Task:
    __slots__ = ('ops', 'kind', 'site')

    def __init__(self, kind, site=0):
        self.ops, self.kind, self.site = [], kind, site


class Loop:
    __slots__ = ('count', 'site', 'tasks', 'nested', 'items')

    def __init__(self, count, site, nested):
        self.count, self.site, self.nested = count, site, nested
        self.tasks, self.items = {}, None


class Trace:
    def __init__(self, path):
        with open(path, 'rb') as f:
            data = f.read()
        if data[:8] != b'PSSPAN1\n':
            sys.exit(f'{path}: no trace')
        size, = struct.unpack_from('<Q', data, 8)
        self.head = head = json.loads(data[16:16 + size])
        self.path, self.planned, self.real = path, max(1, head['planned']), head['real']
        at, frames = 16 + size, head['frames']
        row = struct.Struct('<%dQ' % frames)
        self.sites = [()]
        for _ in range(head['sites']):
            self.sites.append(row.unpack_from(data, at))
            at += row.size
        self.names = Names(head['modules'])
        self.loops, self.tasks, self.calls = {}, {}, {}
        self.seg_label, self.labels, self.label_names = [], {}, []
        self.segments = collections.defaultdict(list)  # by thread: (start, ns, segment)
        self.samples = {}
        self.mutex_at = {}
        self.main = Task('main')
        self.unmatched = 0
        for thread in head['threads']:
            end = at + 32 * thread['events']
            self.read_thread(thread['tid'], memoryview(data)[at:end])
            at = end
            sample = struct.Struct('<Q%dQ' % frames)
            got = []
            for _ in range(thread['samples']):
                got.append(sample.unpack_from(data, at))
                at += sample.size
            self.samples[thread['tid']] = got
        self.written, = struct.unpack_from('<Q', data, at)
        self.make_pools()
        self.drop_quiet_mutexes()
        self.label_segments()

    def read_thread(self, tid, view):
        stack, last = [], 0  # (task, whether it waits)
        if tid == self.head['main_tid']:
            stack.append([self.main, False])
        spans = self.segments[tid]
        label_of = self.seg_label

        def pop(event):
            if len(stack) > (tid == self.head['main_tid']):
                stack.pop()
            else:
                self.unmatched += 1

        def work(now):
            nonlocal last
            if stack and not stack[-1][1] and now > last:
                segment = len(label_of)
                label_of.append(0)
                spans.append((last, now - last, segment))
                stack[-1][0].ops.append((W, now - last, segment))
            last = max(now, last)

        for cpu, what, a, b in struct.iter_unpack('<QQQQ', view):
            kind, id_ = what >> 56, what & ((1 << 56) - 1)
            work(cpu)
            if kind == LOCK or kind == UNLOCK:
                if stack:
                    stack[-1][0].ops.append((A if kind == LOCK else R, id_))
                    if kind == LOCK:
                        self.mutex_at.setdefault(id_, a)
            elif kind == ITER:
                task = Task('loop', self.loops[id_].site if id_ in self.loops else 0)
                self.loops.setdefault(id_, Loop(0, 0, False)).tasks[a] = task
                stack.append([task, False])
            elif kind in (ITER_END, TASK_END, CALLED_END):
                pop(kind)
            elif kind == LOOP:
                loop = self.loops.setdefault(id_, Loop(0, 0, False))
                loop.count, loop.site = a, b
                loop.nested = bool(stack) and stack[-1][0].kind in ('loop', 'task')
                if stack:
                    stack[-1][0].ops.append((L, id_))
                    stack[-1][1] = True
            elif kind == WAIT:
                if stack:
                    stack[-1][0].ops.append((B, id_))
                    stack[-1][1] = True
            elif kind in (LOOP_END, WAIT_END, CALL_END):
                if stack:
                    stack[-1][1] = False
            elif kind == SPAWN:
                self.tasks.setdefault(id_, Task('task')).site = b
                if stack:
                    stack[-1][0].ops.append((S, id_))
            elif kind == TASK:
                stack.append([self.tasks.setdefault(id_, Task('task')), False])
            elif kind == CALL:
                self.calls.setdefault(id_, Task('call')).site = b
                if stack:
                    stack[-1][0].ops.append((C, id_))
                    stack[-1][1] = True
            elif kind == CALLED:
                stack.append([self.calls.setdefault(id_, Task('call')), False])
        if tid == self.head['main_tid']:
            work(self.head['main_cpu'])

    def all_tasks(self):
        yield self.main
        yield from self.calls.values()
        yield from self.tasks.values()
        for loop in self.loops.values():
            yield from loop.tasks.values()

    def make_pools(self):
        """Loops of one body for each thread whose bodies draw pieces under a mutex: the pieces become a pool, from which
        as many workers as there are may draw. Recognised by the site, in a run planned for more threads than worked: all
        of its loops have as many bodies as the run was planned for; each body locks the same mutex first; and almost all
        lock it equally often, as they found nothing left, while those that ran first did so more often."""
        self.pool_sites = {}
        if self.planned <= self.real:
            return
        by_site = collections.defaultdict(list)
        for loop in self.loops.values():
            by_site[loop.site].append(loop)
        for site, loops in by_site.items():
            if all(loop.count == self.planned for loop in loops) and all(self.pool(loop, False) for loop in loops):
                for loop in loops:
                    self.pool(loop, True)
                self.pool_sites[site] = sum(len(loop.items) for loop in loops)

    def pool(self, loop, make):
        first, locks, parts, prologues = None, [], [], []
        for i in sorted(loop.tasks):
            ops = loop.tasks[i].ops
            at = [j for j, op in enumerate(ops) if op[0] == A]
            if not at:
                return False
            if first is None:
                first = ops[at[0]][1]
            if ops[at[0]][1] != first:
                return False
            cuts = [j for j in at if ops[j][1] == first] + [len(ops)]
            locks.append(len(cuts) - 1)
            if make:
                prologues.append(ops[:cuts[0]])
                parts.append([ops[b:e] for b, e in zip(cuts, cuts[1:])])
        if not locks or max(locks) == min(locks) or len(locks) - locks.count(min(locks)) > self.real + 2:
            return False
        if make:  # the pieces that the bodies have drawn, in turns
            loop.items = [part[i] for i in range(max(map(len, parts))) for part in parts if i < len(part)]
            loop.tasks = {i: self.task_of(p, loop.site) for i, p in enumerate(prologues)}
        return True

    @staticmethod
    def task_of(ops, site):
        task = Task('loop', site)
        task.ops = ops
        return task

    def drop_quiet_mutexes(self):
        held, self.lock_count = collections.Counter(), collections.Counter()
        self.work = 0
        lists = [task.ops for task in self.all_tasks()]
        lists += [ops for loop in self.loops.values() for ops in loop.items or ()]
        for ops in lists:
            now, since = 0, {}
            for op in ops:
                if op[0] == W:
                    now += op[1]
                elif op[0] == A:
                    since[op[1]] = now
                    self.lock_count[op[1]] += 1
                elif op[0] == R and op[1] in since:
                    held[op[1]] += now - since.pop(op[1])
            self.work += now
        self.held = held
        self.loud = {m for m, ns in held.items() if ns > 5e-4 * self.work}

        def thinned(ops):
            return [op for op in ops if op[0] not in (A, R) or op[1] in self.loud]
        for task in self.all_tasks():
            task.ops = thinned(task.ops)
        for loop in self.loops.values():
            if loop.items:
                loop.items = [thinned(ops) for ops in loop.items]

    def site_name(self, site):
        own, _ = self.names.chain(self.sites[site], 1) if site else ((), '')
        return own[0] if own else 'main'

    def label(self, text):
        if text not in self.labels:
            self.labels[text] = len(self.label_names)
            self.label_names.append(text)
        return self.labels[text]

    def label_segments(self):
        def mark(op):
            if op is None:
                return None
            if op[0] == L:
                return 'loop in ' + self.site_name(self.loops[op[1]].site)
            if op[0] in (S, B):
                return ('start in ' if op[0] == S else 'wait in ') + self.site_name(self.tasks[op[1]].site)
            return None

        def give(ops, begin, end, where):
            before, pending = begin, []
            for op in ops + [None]:
                if op is not None and op[0] == W:
                    pending.append(op[2])
                    continue
                name = mark(op) if op is not None else end
                if name is None:
                    continue
                if pending:
                    text = where if before == begin and name == end and where else f'{where}{before} → {name}'
                    label = self.label(text)
                    for segment in pending:
                        self.seg_label[segment] = label
                    pending = []
                before = name
        give(self.main.ops, 'start of the program', 'end of the program', '')
        for task in self.calls.values():
            give(task.ops, 'start of the run', 'end of the run', '')
        for task in self.tasks.values():
            give(task.ops, 'begin', 'end', 'background of ' + self.site_name(task.site) + ' ')
        for loop in self.loops.values():
            where = 'in loop of ' + self.site_name(loop.site) + ' '
            for task in loop.tasks.values():
                give(task.ops, 'begin', 'end', where)
            for ops in loop.items or ():
                give(ops, 'begin', 'end', where)


# ---- the replay -------------------------------------------------------------------------------------------------
class Running:
    __slots__ = ('loop', 'tasks', 'next', 'left', 'waiter', 'free', 'items', 'item', 'order')

    def __init__(self, loop, tasks, waiter, order):
        self.loop, self.tasks, self.next, self.left = loop, tasks, 0, len(tasks)
        self.waiter, self.order = waiter, order
        self.items, self.item = loop.items, 0
        self.free = not loop.nested  # the thread that waits for the loop may take other work


class Replay:
    """Schedules recorded work on workers. An idle worker takes the oldest body of a loop or background task. A worker that waits
    for a loop takes its bodies, and other work unless the loop is nested. A worker that waits for a task takes the newest task
    that it has started."""

    def __init__(self, trace, p):
        self.t, self.p = trace, p
        self.now, self.heap, self.order = 0, [], 0
        self.stack = [[] for _ in range(p)]
        self.ready = collections.deque()
        self.idle = dict.fromkeys(range(p))
        self.open = collections.deque()  # loops with bodies to take
        self.spawned = collections.OrderedDict()  # tasks that have not begun: (order, worker)
        self.done, self.begun, self.waiters = set(), set(), {}
        self.loops = {}
        self.mutex, self.queue, self.queued = {}, collections.defaultdict(collections.deque), {}
        self.lock_wait = collections.Counter()
        self.busy, self.lost, self.alone = 0, 0.0, 0.0
        self.current = [None] * p
        n = len(trace.seg_label)
        self.seg_lost, self.seg_alone = [0.0] * n, [0.0] * n
        self.run()

    def run(self):
        self.idle.pop(0)
        self.stack[0].append([self.t.main.ops, 0, None, None])
        self.ready.append(0)
        heap, p = self.heap, self.p
        while True:
            while self.ready:
                self.advance(self.ready.popleft())
            if not heap:
                break
            when, _, w = heapq.heappop(heap)
            dt = when - self.now
            if dt > 0:
                if self.busy:
                    self.lost += dt * (p - self.busy) / p / self.busy
                    if self.busy == 1:
                        self.alone += dt
                self.now = when
            segment, lost, alone = self.current[w]
            self.seg_lost[segment] += self.lost - lost
            self.seg_alone[segment] += self.alone - alone
            self.busy -= 1
            self.ready.append(w)
        if any(self.stack):
            sys.exit('the replay is stuck: the trace is incomplete')
        self.wall = self.now

    def rouse(self, n):
        while n > 0 and self.idle:
            w, _ = self.idle.popitem()
            n -= 1
            self.ready.append(w)

    def take(self, w, newest_of=None):
        """Returns work for the idle worker w as a frame; None if there is none."""
        if newest_of is not None:
            for id_ in reversed(self.spawned):
                if self.spawned[id_][1] == newest_of:
                    return self.begin_task(id_)
        while self.open and self.open[0].next == len(self.open[0].tasks):
            self.open.popleft()
        if self.spawned:
            id_, (order, _) = next(iter(self.spawned.items()))
            if not self.open or order < self.open[0].order:
                return self.begin_task(id_)
        return self.begin_body(self.open[0]) if self.open else None

    def begin_task(self, id_):
        del self.spawned[id_]
        self.begun.add(id_)
        return [self.t.tasks[id_].ops, 0, 'task', id_]

    @staticmethod
    def begin_body(loop):
        task = loop.tasks[loop.next]
        loop.next += 1
        return [task.ops, 0, 'body', loop]

    def wake_waiter(self, w):
        if w is not None:
            self.idle.pop(w, None)
            self.ready.append(w)

    def bodies(self, loop):
        tasks = [loop.tasks[i] for i in sorted(loop.tasks)]
        if loop.items is not None and self.p != self.t.planned and tasks:  # one body for each of the workers
            tasks = (tasks * (self.p // len(tasks) + 1))[:self.p]
        return tasks

    def advance(self, w):
        stack = self.stack[w]
        while True:
            if not stack:
                frame = self.take(w)
                if frame is None:
                    self.idle[w] = None
                    return
                stack.append(frame)
                continue
            frame = stack[-1]
            ops, pc = frame[0], frame[1]
            if pc == len(ops):
                if frame[2] == 'body' and frame[3].items is not None and frame[3].item < len(frame[3].items):
                    frame[0], frame[1] = frame[3].items[frame[3].item], 0
                    frame[3].item += 1
                    continue
                stack.pop()
                self.end(frame)
                continue
            op = ops[pc]
            kind = op[0]
            if kind == W:
                frame[1] = pc + 1
                self.busy += 1
                self.current[w] = op[2], self.lost, self.alone
                self.order += 1
                heapq.heappush(self.heap, (self.now + op[1], self.order, w))
                return
            if kind == L:
                loop = self.loops.get(op[1])
                if loop is None:
                    self.order += 1
                    loop = self.loops[op[1]] = Running(self.t.loops[op[1]], self.bodies(self.t.loops[op[1]]), None,
                                                       self.order)
                    if loop.left > 1:
                        self.open.append(loop)
                        self.rouse(loop.left - 1)
                if loop.next < len(loop.tasks):
                    stack.append(self.begin_body(loop))
                elif loop.left == 0:
                    frame[1] = pc + 1
                    del self.loops[op[1]]
                else:
                    other = self.take(w) if loop.free else None
                    if other is not None:
                        stack.append(other)
                        continue
                    loop.waiter = w
                    if loop.free:
                        self.idle[w] = None
                    return
            elif kind == S:
                self.order += 1
                self.spawned[op[1]] = self.order, w
                frame[1] = pc + 1
                self.rouse(1)
            elif kind == B:
                if op[1] in self.done or (op[1] not in self.begun and op[1] not in self.spawned):
                    frame[1] = pc + 1
                    continue
                other = self.take(w, newest_of=w)
                if other is not None:
                    stack.append(other)
                    continue
                self.waiters[op[1]] = w
                self.idle[w] = None
                return
            elif kind == A:
                if self.mutex.get(op[1]) is None:
                    self.mutex[op[1]] = w
                    frame[1] = pc + 1
                else:
                    self.queue[op[1]].append(w)
                    self.queued[w] = self.now
                    return
            elif kind == R:
                frame[1] = pc + 1
                if self.mutex.get(op[1]) == w:
                    self.mutex[op[1]] = None
                    if self.queue[op[1]]:
                        other = self.queue[op[1]].popleft()
                        self.mutex[op[1]] = other
                        self.lock_wait[op[1]] += self.now - self.queued.pop(other)
                        self.stack[other][-1][1] += 1
                        self.ready.append(other)
            else:  # C
                frame[1] = pc + 1
                stack.append([self.t.calls[op[1]].ops, 0, None, None])

    def end(self, frame):
        if frame[2] == 'task':
            self.done.add(frame[3])
            self.wake_waiter(self.waiters.pop(frame[3], None))
        elif frame[2] == 'body':
            loop = frame[3]
            loop.left -= 1
            if loop.left == 0:
                waiter, loop.waiter = loop.waiter, None
                if waiter is not None:
                    self.wake_waiter(waiter)


# ---- what is serial ---------------------------------------------------------------------------------------------
def by_label(trace, replay):
    rows = collections.defaultdict(lambda: [0.0, 0.0])
    for segment, label in enumerate(trace.seg_label):
        if replay.seg_lost[segment]:
            rows[label][0] += replay.seg_lost[segment]
            rows[label][1] += replay.seg_alone[segment]
    return sorted(((lost, alone, trace.label_names[label]) for label, (lost, alone) in rows.items()), reverse=True)


def by_function(trace, replay):
    """Distributes the lost time of each label over functions, by the samples of its segments."""
    weights = collections.defaultdict(collections.Counter)
    for tid, samples in trace.samples.items():
        spans = trace.segments[tid]
        starts = [s[0] for s in spans]
        for sample in samples:
            i = bisect.bisect_right(starts, sample[0]) - 1
            if i < 0 or sample[0] > spans[i][0] + spans[i][1]:
                continue
            _, ns, segment = spans[i]
            if replay.seg_lost[segment] <= 0:
                continue
            chain, lib = trace.names.chain(sample[3:])  # without the signal handler and its return
            weights[trace.seg_label[segment]][(chain, lib)] += replay.seg_lost[segment] / ns
    out = collections.Counter()
    for lost, _, name in by_label(trace, replay):
        shares = weights[trace.labels[name]]
        total = sum(shares.values())
        if not total:
            out[(('? ' + name,), '')] += lost
        for key, weight in shares.items():
            out[key] += lost * weight / total
    return out


def piece_name(key):
    chain, lib = key
    text = ' < '.join(chain) if chain else '(start, end and libraries)'
    return text + (f' [{lib}]' if lib else '')


WORKERS = (1, 2, 4, 8, 16, 32, 64, 128)


def replayed(paths, outside, workers=WORKERS, reported=(16, 64), top=8):
    """Wall seconds and speed-up by number of workers, with a text for a reader. `outside`: seconds that the process takes
    before and after the trace."""
    traces = {trace.planned: trace for trace in map(Trace, paths)}
    lines, out = [], {"workers": {}, "pieces": {}}
    for trace in traces.values():
        lines.append(f"trace for {trace.planned} threads on {trace.real}: {trace.work / 1e9:.2f} s of work, "
                     f"{len(trace.loops)} loops, {sum(len(x.tasks) for x in trace.loops.values())} bodies, "
                     f"{len(trace.tasks)} background tasks, {sum(trace.lock_count.values())} locks; CPU of the process "
                     f"{trace.head['process_cpu'] / 1e9:.2f} s, of the tracer "
                     f"{sum(t['overhead_ns'] for t in trace.head['threads']) / 1e9:.2f} s")
    lines.append("\n   P  planned for  predicted s  speed-up  busy")
    for p in workers:
        trace = min(traces.values(), key=lambda t: (abs(math.log2(t.planned / p)), -t.planned))
        replay = Replay(trace, p)
        wall = replay.wall / 1e9 + outside
        speedup = out["workers"][1]["wall"] / wall if p > 1 else 1
        lines.append(f"{p:4}  {trace.planned:11}  {wall:11.3f}  {speedup:8.2f}  {trace.work / 1e9 / wall / p:4.0%}")
        out["workers"][p] = {"wall": wall, "speedup": speedup, "planned": trace.planned}
        if p in reported:
            out["pieces"][p] = report(trace, replay, p, wall, outside, top)
    out["text"] = "\n\n".join(["\n".join(lines), *(piece.pop("text") for piece in out["pieces"].values())])
    return out


def report(trace, replay, p, wall, outside, top):
    lost = sum(replay.seg_lost) / 1e9
    lines = [f'P = {p}: {wall:.3f} s = {trace.work / 1e9 / p:.3f} s of shared work + {lost:.3f} s lost, while not all '
             f'work' + (f' + {outside:.3f} s outside of the trace' if outside else '')]
    found = {'functions': [], 'phases': []}
    lines.append('  lost s  of wall  function < its callers')
    for key, ns in by_function(trace, replay).most_common(top):
        lines.append(f'  {ns / 1e9:6.3f}  {ns / 1e9 / wall:6.1%}  {piece_name(key)}')
        found['functions'].append((ns / 1e9, piece_name(key)))
    lines.append('  lost s  alone s  between')
    for ns, alone, name in by_label(trace, replay)[:top]:
        lines.append(f'  {ns / 1e9:6.3f}  {alone / 1e9:7.3f}  {name}')
        found['phases'].append((ns / 1e9, alone / 1e9, name))
    for m, ns in replay.lock_wait.most_common(3):
        if ns > 0.005 * replay.wall * p:
            _, name = trace.names.of(trace.mutex_at[m])
            lines.append(f'  {ns / 1e9 / p:6.3f}           per worker waiting for the mutex of {name} (held '
                         f'{trace.held[m] / 1e9:.3f} s in all, {trace.lock_count[m]} times)')
            found.setdefault('locks', []).append((ns / 1e9 / p, name))
    found['text'] = '\n'.join(lines)
    return found

