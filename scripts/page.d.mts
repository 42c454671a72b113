export function serve(
  folders: Record<string, string>,
  headers?: Record<string, string>,
): Promise<{ origin: string; close: () => void }>;
export function withServer<Answer>(
  folders: Record<string, string>,
  body: (origin: string) => Promise<Answer>,
  headers?: Record<string, string>,
): Promise<Answer>;
export function inPage<Argument, Answer>(
  origin: string,
  measure: (argument: Argument) => Promise<Answer>,
  argument: Argument,
): Promise<Answer>;
