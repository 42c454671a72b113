/** An order for what is wanted and what is still on: what goes stays over what it was over, and under what comes. */
export function stack(before: readonly string[], wanted: readonly string[]): string[] {
  const order = [...wanted];
  let at = 0;
  for (const name of before) {
    if (wanted.includes(name)) at = order.indexOf(name) + 1;
    else order.splice(at++, 0, name);
  }
  return order;
}
