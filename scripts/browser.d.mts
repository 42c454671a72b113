export function chromium(): string;
export function chromedriver(): string;
export function flags(): string[];
export function environment(): Record<string, string>;
